//! The operation process card of a recipe as data: what the kind says on it, and what the plant adds in `card.toml`.

use super::characteristic::Characteristic;
use super::em_relay;
use serde::Deserialize;
use std::collections::BTreeMap;

/// Steps of every kind by the names of `card.toml`, in the order of the card.
pub const STEPS: &[&str] = &em_relay::card::STEPS;

/// Id of a text of the catalogue.
pub type TextId = &'static str;

/// What the kind says.
#[derive(Debug, Clone, PartialEq)]
pub struct Card {
    /// What the part is rated, with its heading.
    pub rating: (TextId, Vec<Piece>),
    /// What is done to a part, in order.
    pub steps: Vec<Step>,
    /// Counts that the remarks name.
    pub counts: Vec<(TextId, u32)>,
}

/// One line of the card.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Key of its time quota in `card.toml`.
    pub name: &'static str,
    /// Text of the catalogue: `.what` is done, with which `.tooling`, and the `.requirement` on sensors.
    pub text: TextId,
    /// How the part is driven; empty where it is not.
    pub drive: Vec<Piece>,
    /// What must come out.
    pub demand: Demand,
}

/// A piece of a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Piece {
    /// A figure of the recipe.
    Figure(f64),
    /// What stands between figures, alike in every language.
    Literal(&'static str),
    /// A text.
    Text(TextId),
}

/// What must come out of a step.
#[derive(Debug, Clone, PartialEq)]
pub enum Demand {
    /// Sensors report what the text of the step says.
    Sensors,
    /// Values lie within the limits of these characteristics.
    Within(Vec<Characteristic>),
}

/// Planned times of one step, s.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
pub struct Quota {
    /// The step itself.
    pub machine_s: f64,
    /// Beside it.
    pub auxiliary_s: f64,
}

/// What the plant adds to the recipe, from `card.toml`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct CardSettings {
    /// Workshop.
    pub workshop: String,
    /// Number of the operation in the process.
    pub operation_no: String,
    /// Type of the rig.
    pub equipment_model: String,
    /// Its inventory number.
    pub equipment_no: String,
    /// Number of nest and pin block.
    pub fixture_no: String,
    /// Parts tested at the same time.
    pub pieces_at_once: u32,
    /// Preparing and ending a lot, min.
    pub preparation_min: f64,
    /// Time quota by step.
    pub quota: BTreeMap<String, Quota>,
}

impl Step {
    /// A step of the handling, which drives no part and measures nothing.
    pub fn handling(name: &'static str, text: TextId) -> Self {
        Self {
            name,
            text,
            drive: Vec::new(),
            demand: Demand::Sensors,
        }
    }
}
