//! Operation process card of a resistor.

use super::Parameter;
use super::recipe::ResistorRecipe;
use crate::dut::card::{Card, Demand, Piece, Step};

/// Returns the card of a recipe.
pub fn card(resistor: &ResistorRecipe) -> Card {
    let level = resistor.test.level_v;
    let drive = vec![Piece::Figure(level), Piece::Literal(" V")];
    let measure = Step {
        name: "coil",
        text: "card-resistance",
        drive: drive.clone(),
        demand: Demand::Within(vec![Parameter::Resistance.into()]),
    };
    Card {
        rating: ("card-test_voltage", drive),
        steps: vec![
            Step::handling("load", "card-load"),
            Step::handling("clamp", "card-clamp"),
            measure,
            Step::handling("sort", "card-sort"),
        ],
        counts: Vec::new(),
    }
}
