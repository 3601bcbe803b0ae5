//! The operation process card of a recipe as data: what the kind of device enters, and what the plant adds in
//! `card.toml`.

use super::characteristic::Characteristic;
use super::em_relay;
use serde::Deserialize;
use std::collections::BTreeMap;

/// Names of the steps of every kind, as `card.toml` spells them, in the order of the card.
pub const STEPS: &[&str] = &em_relay::card::STEPS;

/// Id of a text in the catalogue (`locale/*.ftl`).
pub type TextId = &'static str;

/// The part of the card that the kind of device fills in.
#[derive(Debug, Clone, PartialEq)]
pub struct Card {
    /// Heading of the line with the part's rating, and the rating itself.
    pub rating: (TextId, Vec<Piece>),
    /// What is done to a part, in order.
    pub steps: Vec<Step>,
    /// Counts that the remarks on the card state, each with the id of the remark's text.
    pub counts: Vec<(TextId, u32)>,
}

/// One line of the card.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Key of the step's time quota in `card.toml`.
    pub name: &'static str,
    /// Id of the step's text, which has three attributes: `.what` (the action), `.tooling`, and `.requirement` (on
    /// sensors).
    pub text: TextId,
    /// What drives the part during the step; empty where nothing does.
    pub drive: Vec<Piece>,
    /// Requirement on the outcome of the step.
    pub demand: Demand,
}

/// A piece of a line of the card.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Piece {
    /// A figure of the recipe.
    Figure(f64),
    /// Characters between two figures, the same in every language.
    Literal(&'static str),
    /// A text of the catalogue.
    Text(TextId),
}

/// Requirement on the outcome of a step.
#[derive(Debug, Clone, PartialEq)]
pub enum Demand {
    /// The sensors must report what the text of the step says.
    Sensors,
    /// The values must lie within the limits of these characteristics.
    Within(Vec<Characteristic>),
}

/// Planned times of one step, s.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
pub struct Quota {
    /// Time of the step itself.
    pub machine_s: f64,
    /// Auxiliary time in addition to `machine_s`.
    pub auxiliary_s: f64,
}

/// What the plant adds to the recipe, from `card.toml`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct CardSettings {
    /// Name of the workshop.
    pub workshop: String,
    /// Number of the operation in the process.
    pub operation_no: String,
    /// Model of the rig.
    pub equipment_model: String,
    /// Inventory number of the rig.
    pub equipment_no: String,
    /// Inventory number of the fixture (nest and pin block).
    pub fixture_no: String,
    /// Number of parts tested at the same time.
    pub pieces_at_once: u32,
    /// Time to prepare and to end a lot, min.
    pub preparation_min: f64,
    /// Time quotas by name of the step.
    pub quota: BTreeMap<String, Quota>,
}

impl Step {
    /// Returns a step that moves the part, and neither drives nor measures it.
    pub fn handling(name: &'static str, text: TextId) -> Self {
        Self {
            name,
            text,
            drive: Vec::new(),
            demand: Demand::Sensors,
        }
    }
}
