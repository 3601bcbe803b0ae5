//! A kind of device under test on a rig, as the station holds it: recipe, calibration, and what it has learned from
//! earlier parts.

use super::accuracy::AccuracySettings;
use super::batch::{BatchOrder, BatchTest};
use super::calibration::Calibration;
use super::em_relay;
use super::em_relay::settings::{ReferenceSet, ReferenceSettings};
use super::experiment::Experiment;
use super::procedure::Procedure;
use super::promise::Broken;
use super::record::TestRecord;
use super::resistor;
use super::ssr;
use super::thermostat;
use super::thermostat::certificate::Certificate;
use crate::instrument::act::Act;
use crate::instrument::readings::Readings;
use crate::rig::point::Thermometer;
use crate::rig::wiring::Wiring;
use std::ops::{Deref, DerefMut};
use texts::Message;
use thiserror::Error;
use units::{Ohm, RigTime};

/// Time at which a calibration is made, and how long it is valid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Made {
    /// Microseconds since 1970 UTC.
    pub at_us: i64,
    /// How long the calibration is valid, microseconds.
    pub valid_us: i64,
    /// True on the simulated rig; a real rig never uses such a calibration.
    pub simulated: bool,
}

/// Data of the rig that a kind of device may use.
#[derive(Debug, Clone, Copy)]
pub struct Rig<'a> {
    /// Points, modules and lines.
    pub wiring: &'a Wiring,
    /// References on the interface board, if it has any.
    pub reference: Option<&'a ReferenceSettings>,
    /// Accuracies that the makers of the instruments specify.
    pub accuracy: &'a AccuracySettings,
    /// Reference parts, that is, parts with a certificate.
    pub reference_parts: &'a ReferenceSet,
    /// Certificate of thermometer chain and sockets, if the plant has one.
    pub certificate: Option<&'a Certificate>,
}

/// Which part is tested, and how.
#[derive(Debug, Clone, Copy)]
pub struct TestOrder<'a> {
    /// True when the test must repeat every measurement to confirm its result: for a first article, or for a check
    /// against a certificate.
    pub thorough: bool,
    /// Serial number of the reference part in the nest while the rig learns from reference parts; `None` in any other
    /// test.
    pub teaching: Option<&'a str>,
    /// How often this part has been tested, including this test, from 1.
    pub number: u8,
}

/// Why the rig cannot be calibrated, or disagrees with a certificate.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CalibrationFault {
    /// A reference on the interface board has a wrong reading.
    #[error(transparent)]
    Reference(#[from] em_relay::reference::ReferenceFault),
    /// A reference part cannot be used, or disagrees with its certificate or with the other parts.
    #[error(transparent)]
    ReferencePart(#[from] em_relay::reference_part::Misfit),
}

impl CalibrationFault {
    /// Returns the fault as a message of family `fault`, with its figures.
    pub fn message(&self) -> Message {
        match self {
            Self::Reference(fault) => fault.message(),
            Self::ReferencePart(misfit) => misfit.message(),
        }
    }
}

/// A kind of device on a rig: recipe, calibration and what it has learned from parts. The default methods are those of
/// a kind that needs no calibration and learns nothing.
pub trait DeviceUnderTest {
    /// Begins the test of the part in the nest. The probes must be up.
    fn begin(&self, order: &TestOrder, now: RigTime) -> Procedure;

    /// Begins the test of all parts in a rack, behind its locked door.
    fn begin_batch(&self, order: &BatchOrder, _now: RigTime) -> Box<dyn BatchTest> {
        panic!("a kind for a nest gets a batch: {order:?}")
    }

    /// Begins an experiment without parts, behind the locked door of the rack.
    fn begin_experiment(&self, what: Experiment, _now: RigTime) -> Box<dyn BatchTest> {
        panic!("a kind without experiments gets one: {what:?}")
    }

    /// Returns the acts that cool the rack after a test and after any restart, or without `on` those that end the
    /// cooling before the door is unlocked. Both leave every source of heat off.
    fn cooling(&self, _on: bool) -> Vec<Act> {
        Vec::new()
    }

    /// Returns the thermometers in the air around the rack. A rack counts as cool only when one of these has a reading
    /// and none reads hot: a stuck thermometer in the rack must not unlock the door.
    fn air_thermometers(&self) -> Vec<Thermometer> {
        Vec::new()
    }

    /// Returns the thermometers on surfaces that give off heat, such as a heater. While one of these reads hot, the rack
    /// does not count as cool: the fan runs on and the door stays locked. One without a reading decides nothing.
    fn hot_surfaces(&self) -> Vec<Thermometer> {
        Vec::new()
    }

    /// Returns when the calibration in force expires, microseconds since 1970 UTC; `None` for a kind without
    /// calibration.
    fn due_at_us(&self) -> Option<i64> {
        None
    }

    /// Returns the serial numbers of the reference parts, in the order of the magazine.
    fn reference_serials(&self) -> Vec<String> {
        Vec::new()
    }

    /// Returns true when the calibration is complete, so that parts may be judged.
    fn is_calibrated(&self) -> bool {
        true
    }

    /// Returns the acts that measure the references on the board; they need an empty nest with the probes up.
    fn reference_acts(&self) -> Vec<Act> {
        Vec::new()
    }

    /// Computes the factors from the readings of [`Self::reference_acts`].
    ///
    /// # Errors
    /// Fails with the channel or the reference whose reading is wrong.
    fn conclude_references(
        &mut self,
        _readings: &Readings,
        _made: Made,
    ) -> Result<(), CalibrationFault> {
        Ok(())
    }

    /// Discards the calibration, so that references and reference parts have to be measured again.
    fn forget_calibration(&mut self) {}

    /// Learns from a reference part. After the part marked `_last`, completes and returns the calibration.
    ///
    /// # Errors
    /// Fails when the part cannot be used, or with the part that does not fit the others.
    fn learn_reference(
        &mut self,
        serial: &str,
        _record: &TestRecord,
        _last: bool,
    ) -> Result<Option<Calibration>, CalibrationFault> {
        panic!("{NO_REFERENCE_PARTS}: {serial}")
    }

    /// Completes the calibration with the reference parts measured so far, because the measurement of the last one was
    /// interrupted.
    ///
    /// # Errors
    /// Fails when there are too few parts, or with the part that does not fit the others.
    fn conclude_reference_parts(&mut self) -> Result<Calibration, CalibrationFault> {
        panic!("{NO_REFERENCE_PARTS}")
    }

    /// Learns from a part of the lot; `_pass` is true when the part passed.
    fn learn(&mut self, _record: &TestRecord, _pass: bool) {}

    /// Compares the results of a reference part with its certificate.
    ///
    /// # Errors
    /// Fails with the result that disagrees with the certificate.
    fn check(&mut self, serial: &str, _record: &TestRecord) -> Result<(), CalibrationFault> {
        panic!("{NO_REFERENCE_PARTS}: {serial}")
    }

    /// Returns the standard deviations promised by `rig.toml` or the recipe that measurements have disproved since the
    /// last call.
    fn broken_promises(&mut self) -> Vec<Broken> {
        Vec::new()
    }

    /// Returns the resistance of the probes in series with the part, as the mean over the last parts of the lot; `None`
    /// before the first part.
    fn probe_contact(&self) -> Option<Ohm> {
        None
    }

    /// Returns [`Self::probe_contact`] once it is the mean of enough parts that an alarm may depend on it.
    fn settled_probe_contact(&self) -> Option<Ohm> {
        None
    }
}

const NO_REFERENCE_PARTS: &str = "a kind without reference parts gets one";

/// A kind of device on a rig, as the station holds it; outlives one part.
#[derive(Debug, Clone)]
pub enum Device {
    /// Electromagnetic relay.
    EmRelay(Box<em_relay::Device>),
    /// Resistor.
    Resistor(Box<resistor::Device>),
    /// Solid-state relay.
    Ssr(Box<ssr::Device>),
    /// Temperature relay.
    Thermostat(Box<thermostat::Device>),
    /// A kind for tests of batches.
    #[cfg(test)]
    Mock(Box<super::mock::MockDevice>),
}

impl Deref for Device {
    type Target = dyn DeviceUnderTest;

    fn deref(&self) -> &Self::Target {
        match self {
            Self::EmRelay(relay) => relay.as_ref(),
            Self::Resistor(resistor) => resistor.as_ref(),
            Self::Ssr(ssr) => ssr.as_ref(),
            Self::Thermostat(thermostat) => thermostat.as_ref(),
            #[cfg(test)]
            Self::Mock(mock) => mock.as_ref(),
        }
    }
}

impl DerefMut for Device {
    fn deref_mut(&mut self) -> &mut Self::Target {
        match self {
            Self::EmRelay(relay) => relay.as_mut(),
            Self::Resistor(resistor) => resistor.as_mut(),
            Self::Ssr(ssr) => ssr.as_mut(),
            Self::Thermostat(thermostat) => thermostat.as_mut(),
            #[cfg(test)]
            Self::Mock(mock) => mock.as_mut(),
        }
    }
}
