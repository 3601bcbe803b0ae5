//! A specimen of any kind: what a lot draws, and what the probes find on it.
//!
//! Nothing outside this file knows which kinds there are. A kind is a folder beside it with a lot that draws its
//! parts and a part that answers on the probes; here stands one variant for each.

use std::ops::{Deref, DerefMut};

use serde::Deserialize;

use super::WorldOptions;
use super::draw::Draw;
use super::probes::{Change, Contact, Pins, Supply};
use super::relay::{self, Relay};
use super::resistor::{self, Resistor};
use super::table::WorldTable;
use crate::config::{ConfigError, content, read_text};
use crate::truth::PartTruth;

/// Temperature at which true values are stated, degrees Celsius.
pub const REFERENCE_C: f64 = 23.0;

/// What the interface board finds on the pins of a specimen. A kind without contacts leaves these out.
pub trait OnProbes {
    /// Pins that meet their probes.
    fn pins(&self) -> Pins;

    /// Resistance between the two input pins now, ohm; infinite when open.
    fn input_ohm(&self) -> f64;

    /// Current through the input pins now, ampere.
    fn input_a(&self) -> f64;

    /// Another supply at the input pins from now on; the specimen must have been advanced to `t_us`.
    fn drive(&mut self, t_us: f64, supply: Supply);

    /// Goes on to `t_us`, or to the first change of a contact before it.
    fn advance(&mut self, t_us: f64) -> Option<Change>;

    /// Resistance of a contact, milliohm; none while it is open.
    fn contact_mohm(&self, _contact: Contact) -> Option<f64> {
        None
    }

    /// The contact source flows through a contact.
    fn source_on(&mut self, _contact: Contact) {}

    /// Thermal EMF in the contact circuit, volts.
    fn emf_v(&self) -> f64 {
        0.0
    }

    /// True values so far, without order and place.
    fn truth(&self) -> PartTruth;
}

/// Kind of a lot: key `kind` of its recipe; a recipe without the key is one for relays.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LotKind {
    /// Electromagnetic relays with one changeover contact.
    #[default]
    EmRelay,
    /// Dummies that hold one resistor, for a check of the fixture.
    Resistor,
}

/// A specimen outside the magazine.
#[derive(Debug, Clone)]
pub enum Specimen {
    /// An electromagnetic relay.
    Relay(Box<Relay>),
    /// A dummy that holds a resistor.
    Resistor(Resistor),
}

impl Deref for Specimen {
    type Target = dyn OnProbes;

    fn deref(&self) -> &Self::Target {
        match self {
            Self::Relay(relay) => relay.as_ref(),
            Self::Resistor(resistor) => resistor,
        }
    }
}

impl DerefMut for Specimen {
    fn deref_mut(&mut self) -> &mut Self::Target {
        match self {
            Self::Relay(relay) => relay.as_mut(),
            Self::Resistor(resistor) => resistor,
        }
    }
}

/// How a part comes out of the magazine.
#[derive(Debug, Clone)]
pub struct Arrival {
    /// Instant, microseconds.
    pub t_us: f64,
    /// The magazine has soaked at this temperature.
    pub track_c: f64,
    /// Air around the nest.
    pub ambient_c: f64,
    /// Chance of what the part does from now on.
    pub draw: Draw,
    /// This pin of it misses its Kelvin probes.
    pub dirty_pin: Option<usize>,
    /// It lies the wrong way round.
    pub turned: bool,
}

/// Parts of one recipe, drawn by seed and place.
#[derive(Debug, Clone)]
pub enum Lot {
    /// Relays, with golden parts.
    Relay(Box<relay::Lot>),
    /// Dummies; none of them has a certificate.
    Resistor(resistor::Lot),
}

impl Lot {
    /// The lot of a recipe.
    ///
    /// # Errors
    /// The recipe or what belongs to its kind cannot be read, or there is no such kind.
    pub fn read(options: &WorldOptions, world: &WorldTable) -> Result<Self, ConfigError> {
        Ok(match read_kind(options)? {
            LotKind::EmRelay => Self::Relay(Box::new(relay::Lot::read(options, world)?)),
            LotKind::Resistor => Self::Resistor(resistor::Lot::new(world)),
        })
    }

    /// Number of golden parts.
    pub fn golden(&self) -> u64 {
        match self {
            Self::Relay(lot) => lot.golden(),
            Self::Resistor(_) => 0,
        }
    }

    /// The lot part with this place under a seed.
    pub fn part(&self, seed: u64, index: u64, arrival: Arrival) -> Specimen {
        match self {
            Self::Relay(lot) => Specimen::Relay(Box::new(lot.part(seed, index, arrival))),
            Self::Resistor(lot) => Specimen::Resistor(lot.part(seed, index, &arrival)),
        }
    }

    /// The golden part of this place, none past the last; on another day it is the same body with another temperature.
    pub fn golden_part(
        &self,
        seed: u64,
        index: u64,
        other_day: bool,
        arrival: Arrival,
    ) -> Option<Specimen> {
        match self {
            Self::Relay(lot) => lot
                .golden_part(seed, index, other_day, arrival)
                .map(|relay| Specimen::Relay(Box::new(relay))),
            Self::Resistor(_) => None,
        }
    }
}

#[derive(Deserialize)]
struct RecipeFile {
    #[serde(default)]
    kind: LotKind,
}

fn read_kind(options: &WorldOptions) -> Result<LotKind, ConfigError> {
    let path = options
        .config_dir
        .join("recipes")
        .join(format!("{}.toml", options.recipe));
    let text = read_text(&path)?;
    let file: RecipeFile = toml::from_str(&text).map_err(|e| content(&path, &text, &e))?;
    Ok(file.kind)
}
