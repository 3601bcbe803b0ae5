//! The kind under test as the station holds it: recipe, calibration, and what parts have taught.

use super::accuracy::AccuracySettings;
use super::calibration::Calibration;
use super::em_relay;
use super::em_relay::settings::{ReferenceSet, ReferenceSettings};
use super::procedure::Procedure;
use super::promise::Broken;
use super::recipe::{DeviceRecipe, Recipe};
use super::record::TestRecord;
use super::resistor;
use crate::instrument::act::Act;
use crate::instrument::readings::Readings;
use crate::rig::point::MissingPoint;
use crate::rig::wiring::Wiring;
use std::sync::Arc;
use texts::Message;
use thiserror::Error;
use units::{Ohm, RigTime};

/// When a calibration is made and how long it holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Made {
    /// Microseconds since 1970 UTC.
    pub at_us: i64,
    /// Life, microseconds.
    pub valid_us: i64,
    /// On the simulated rig: never used on a real one.
    pub simulated: bool,
}

/// What a kind may need to know of the rig.
#[derive(Debug, Clone, Copy)]
pub struct Rig<'a> {
    /// Points, modules and lines.
    pub wiring: &'a Wiring,
    /// References on the interface board, if it has any.
    pub reference: Option<&'a ReferenceSettings>,
    /// What the makers promise.
    pub accuracy: &'a AccuracySettings,
    /// Parts with a certificate.
    pub reference_parts: &'a ReferenceSet,
}

/// How a part is to be tested.
#[derive(Debug, Clone, Copy)]
pub struct TestOrder<'a> {
    /// Every result by confirmation measurements: a first article, or a check against a certificate.
    pub thorough: bool,
    /// Serial number of a reference part while reference parts teach.
    pub teaching: Option<&'a str>,
    /// Number of the test of this part, from 1.
    pub number: u8,
}

/// Why the rig cannot be calibrated, or does not read as certified.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CalibrationFault {
    /// A reference on the board.
    #[error(transparent)]
    Reference(#[from] em_relay::reference::ReferenceFault),
    /// A reference part.
    #[error(transparent)]
    ReferencePart(#[from] em_relay::reference_part::Misfit),
}

impl CalibrationFault {
    /// Its text of the family `fault`, with its figures.
    pub fn message(&self) -> Message {
        match self {
            Self::Reference(fault) => fault.message(),
            Self::ReferencePart(misfit) => misfit.message(),
        }
    }
}

const NO_REFERENCE_PARTS: &str = "a resistor has no reference parts, so none was planned";

/// A kind of device on a rig: what outlives one part.
#[derive(Debug, Clone)]
pub enum Device {
    /// Electromagnetic relay.
    EmRelay(Box<em_relay::Device>),
    /// Resistor: needs no calibration and learns nothing.
    Resistor(Box<resistor::Device>),
}

impl Device {
    /// Puts `recipe` on a rig that was calibrated before, or was not.
    ///
    /// # Errors
    /// Names the first point of the kind that the rig does not have.
    pub fn new(
        recipe: Arc<Recipe>,
        rig: &Rig,
        stored: Option<Calibration>,
    ) -> Result<Self, MissingPoint> {
        match &recipe.device {
            DeviceRecipe::EmRelay(relay) => {
                let stored = stored.map(|Calibration::EmRelay(factors)| factors);
                let relay = Arc::new(relay.clone());
                let device = em_relay::Device::new(recipe, relay, rig, stored)?;
                Ok(Self::EmRelay(Box::new(device)))
            }
            DeviceRecipe::Resistor(resistor) => {
                let resistor = Arc::new(resistor.clone());
                let device = resistor::Device::new(recipe, resistor, rig)?;
                Ok(Self::Resistor(Box::new(device)))
            }
        }
    }

    /// When the factors in force run out, microseconds since 1970 UTC; never for a kind that needs none.
    pub fn due_at_us(&self) -> Option<i64> {
        match self {
            Self::EmRelay(relay) => Some(relay.calibration().due_at_us),
            Self::Resistor(_) => None,
        }
    }

    /// Serial numbers of the reference parts, in the order of the magazine; empty for a kind that needs none.
    pub fn reference_serials(&self) -> Vec<String> {
        match self {
            Self::EmRelay(relay) => relay.reference_serials().map(str::to_owned).collect(),
            Self::Resistor(_) => Vec::new(),
        }
    }

    /// True when the kind measures references and reference parts before a lot.
    pub fn needs_calibration(&self) -> bool {
        match self {
            Self::EmRelay(_) => true,
            Self::Resistor(_) => false,
        }
    }

    /// True when parts may be judged.
    pub fn is_calibrated(&self) -> bool {
        match self {
            Self::EmRelay(relay) => relay.is_calibrated(),
            Self::Resistor(_) => true,
        }
    }

    /// The measurements against the references on the board, in the empty nest with the probes up.
    pub fn reference_acts(&self) -> Vec<Act> {
        match self {
            Self::EmRelay(relay) => relay.reference_acts(),
            Self::Resistor(_) => Vec::new(),
        }
    }

    /// Draws the factors from what [`Self::reference_acts`] has read.
    ///
    /// # Errors
    /// Names the channel or the reference that does not read as it must.
    pub fn conclude_references(
        &mut self,
        readings: &Readings,
        made: Made,
    ) -> Result<(), CalibrationFault> {
        match self {
            Self::EmRelay(relay) => Ok(relay.conclude_references(readings, made)?),
            Self::Resistor(_) => Ok(()),
        }
    }

    /// Forgets the calibration: references and reference parts are measured again.
    pub fn forget_calibration(&mut self) {
        match self {
            Self::EmRelay(relay) => relay.forget_calibration(),
            Self::Resistor(_) => {}
        }
    }

    /// Begins the test of the part in the nest; the probes are up.
    pub fn begin(&self, order: &TestOrder, now: RigTime) -> Procedure {
        match self {
            Self::EmRelay(relay) => Procedure::EmRelay(Box::new(relay.begin(order, now))),
            Self::Resistor(resistor) => Procedure::Resistor(Box::new(resistor.begin(order, now))),
        }
    }

    /// Learns from a reference part. With the `last` one the calibration is complete and returned.
    ///
    /// # Errors
    /// Says why the part cannot be used, or which one does not fit the others.
    pub fn learn_reference(
        &mut self,
        serial: &str,
        record: &TestRecord,
        last: bool,
    ) -> Result<Option<Calibration>, CalibrationFault> {
        match self {
            Self::EmRelay(relay) => {
                let complete = relay.learn_reference(serial, record, last)?;
                Ok(complete.map(Calibration::EmRelay))
            }
            Self::Resistor(_) => panic!("{NO_REFERENCE_PARTS}"),
        }
    }

    /// Completes the calibration with the reference parts measured so far: the last one was interrupted.
    ///
    /// # Errors
    /// Says which part does not fit the others, or that there are too few.
    pub fn conclude_reference_parts(&mut self) -> Result<Calibration, CalibrationFault> {
        match self {
            Self::EmRelay(relay) => Ok(Calibration::EmRelay(relay.conclude_reference_parts()?)),
            Self::Resistor(_) => panic!("{NO_REFERENCE_PARTS}"),
        }
    }

    /// Learns from a part of the lot that passed or not.
    pub fn learn(&mut self, record: &TestRecord, pass: bool) {
        match self {
            Self::EmRelay(relay) => relay.learn(record, pass),
            Self::Resistor(_) => {}
        }
    }

    /// Compares what was measured on a reference part with its certificate.
    ///
    /// # Errors
    /// Names what does not agree.
    pub fn check(&self, serial: &str, record: &TestRecord) -> Result<(), CalibrationFault> {
        match self {
            Self::EmRelay(relay) => Ok(relay.check(serial, record)?),
            Self::Resistor(_) => panic!("{NO_REFERENCE_PARTS}"),
        }
    }

    /// Promises of the rig's file found broken since the last call.
    pub fn broken_promises(&mut self) -> Vec<Broken> {
        match self {
            Self::EmRelay(relay) => relay.broken_promises(),
            Self::Resistor(_) => Vec::new(),
        }
    }

    /// Resistance of the probes in series with the part, mean over the last parts of the lot; none before a part has told it.
    pub fn probe_contact(&self) -> Option<Ohm> {
        match self {
            Self::EmRelay(relay) => relay.probe_contact(),
            Self::Resistor(_) => None,
        }
    }

    /// The same, once enough parts have told it to be a trend.
    pub fn settled_probe_contact(&self) -> Option<Ohm> {
        match self {
            Self::EmRelay(relay) => relay.settled_probe_contact(),
            Self::Resistor(_) => None,
        }
    }
}
