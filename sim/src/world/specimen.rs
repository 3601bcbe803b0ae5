//! A specimen of any kind: drawn from its lot, probed by the interface board.
//!
//! This file lists the kinds, one variant for each; `table.rs` reads the table of each, `mod.rs` names its folder. A kind
//! is a folder beside this file, with a lot that draws its parts and a part that implements [`ProbeInterface`].

use std::ops::{Deref, DerefMut};

use super::WorldOptions;
use super::draw::Draw;
use super::probes::{Change, Contact, Pins, Supply};
use super::relay::{self, Relay};
use super::resistor::{self, Resistor};
use super::ssr::{self, Ssr};
use super::table::WorldTable;
use crate::config::ConfigError;
use crate::truth::PartTruth;

/// Reference temperature of true values, degrees Celsius.
pub const REFERENCE_C: f64 = 23.0;

/// Signals that the interface board finds on the pins of a specimen; a kind without contacts keeps the defaults.
pub trait ProbeInterface {
    /// Returns the pins that touch their probes.
    fn pins(&self) -> Pins;

    /// Returns the present resistance between the input pins, ohm; infinite when open.
    fn input_ohm(&self) -> f64;

    /// Returns the present current through the input pins, ampere.
    fn input_a(&self) -> f64;

    /// Changes the drive at the input pins; the specimen must already be at `t_us`.
    fn drive(&mut self, t_us: f64, supply: Supply);

    /// Advances to `t_us`, or to the first change of a contact before it.
    fn advance(&mut self, t_us: f64) -> Option<Change>;

    /// Returns the resistance of a contact, milliohm; `None` while it is open.
    fn contact_mohm(&self, _contact: Contact) -> Option<f64> {
        None
    }

    /// Notes that the current of the contact source flows through a contact.
    fn source_on(&mut self, _contact: Contact) {}

    /// Returns the thermal EMF in the contact circuit, volts.
    fn emf_v(&self) -> f64 {
        0.0
    }

    /// Returns the true values so far, without sequence number and bin.
    fn truth(&self) -> PartTruth;
}

/// A part that has left the magazine, of any kind.
#[derive(Debug, Clone)]
pub enum Specimen {
    /// An electromagnetic relay.
    Relay(Box<Relay>),
    /// A dummy that contains a resistor.
    Resistor(Resistor),
    /// A solid-state relay.
    Ssr(Box<Ssr>),
}

impl Specimen {
    /// Returns the solid-state relay; `None` for another kind.
    pub fn as_ssr(&self) -> Option<&Ssr> {
        match self {
            Self::Ssr(part) => Some(part),
            Self::Relay(_) | Self::Resistor(_) => None,
        }
    }

    /// Returns the solid-state relay to drive; `None` for another kind.
    pub fn as_ssr_mut(&mut self) -> Option<&mut Ssr> {
        match self {
            Self::Ssr(part) => Some(part),
            Self::Relay(_) | Self::Resistor(_) => None,
        }
    }
}

impl Deref for Specimen {
    type Target = dyn ProbeInterface;

    fn deref(&self) -> &Self::Target {
        match self {
            Self::Relay(relay) => relay.as_ref(),
            Self::Resistor(resistor) => resistor,
            Self::Ssr(part) => part.as_ref(),
        }
    }
}

impl DerefMut for Specimen {
    fn deref_mut(&mut self) -> &mut Self::Target {
        match self {
            Self::Relay(relay) => relay.as_mut(),
            Self::Resistor(resistor) => resistor,
            Self::Ssr(part) => part.as_mut(),
        }
    }
}

/// Conditions under which a part leaves the magazine.
#[derive(Debug, Clone)]
pub struct Arrival {
    /// Instant, microseconds.
    pub t_us: f64,
    /// Temperature of the part after its time in the magazine, degrees Celsius.
    pub track_c: f64,
    /// Air temperature around the nest, degrees Celsius.
    pub ambient_c: f64,
    /// Random stream of the part's operations.
    pub draw: Draw,
    /// Index of a pin that misses its Kelvin probes; `None` when no pin does.
    pub dirty_pin: Option<usize>,
    /// True when the part is misoriented.
    pub misoriented: bool,
}

/// Parts of one recipe, drawn by seed and index.
#[derive(Debug, Clone)]
pub enum Lot {
    /// Relays, with reference parts.
    Relay(Box<relay::Lot>),
    /// Dummies; none has a certificate.
    Resistor(resistor::Lot),
    /// Solid-state relays; none has a certificate.
    Ssr(Box<ssr::Lot>),
}

impl Lot {
    /// Reads the lot of a recipe; without key `kind` the recipe is for relays.
    ///
    /// # Errors
    /// Fails when the recipe or a file of its kind cannot be read, or the kind is unknown.
    pub fn read(options: &WorldOptions, world: &WorldTable) -> Result<Self, ConfigError> {
        let recipe = options.files.recipe(&options.recipe)?;
        match recipe.get::<Option<String>>("kind")?.as_deref() {
            None | Some("em_relay") => {
                let world = world.relays(&options.files)?;
                let lot = relay::Lot::read(&recipe, options, &world)?;
                Ok(Self::Relay(Box::new(lot)))
            }
            Some("resistor") => {
                let lot = resistor::Lot::new(world, &options.files)?;
                Ok(Self::Resistor(lot))
            }
            Some("ssr") => {
                let lot = ssr::Lot::read(&recipe, options, world)?;
                Ok(Self::Ssr(Box::new(lot)))
            }
            Some(_) => Err(recipe.wrong("kind", "em_relay, resistor or ssr")),
        }
    }

    /// Returns the number of reference parts.
    pub fn reference_parts(&self) -> u64 {
        match self {
            Self::Relay(lot) => lot.reference_parts(),
            Self::Resistor(_) | Self::Ssr(_) => 0,
        }
    }

    /// Returns the lot part at an index under a seed.
    pub fn part(&self, seed: u64, index: u64, arrival: Arrival) -> Specimen {
        match self {
            Self::Relay(lot) => Specimen::Relay(Box::new(lot.part(seed, index, arrival))),
            Self::Resistor(lot) => Specimen::Resistor(lot.part(seed, index, &arrival)),
            Self::Ssr(lot) => Specimen::Ssr(Box::new(lot.part(seed, index, &arrival))),
        }
    }

    /// Returns the reference part at an index, `None` past the last; `other_day` gives the same body another
    /// temperature.
    pub fn reference_part(
        &self,
        seed: u64,
        index: u64,
        other_day: bool,
        arrival: Arrival,
    ) -> Option<Specimen> {
        match self {
            Self::Relay(lot) => lot
                .reference_part(seed, index, other_day, arrival)
                .map(|relay| Specimen::Relay(Box::new(relay))),
            Self::Resistor(_) | Self::Ssr(_) => None,
        }
    }
}
