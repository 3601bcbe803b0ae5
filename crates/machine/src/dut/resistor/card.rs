//! What the operation process card says of a resistor.

use super::Parameter;
use super::recipe::ResistorRecipe;
use crate::dut::card::{Card, Demand, Piece, Step};
use crate::dut::words::Words;

/// The card of a recipe.
pub fn card(resistor: &ResistorRecipe) -> Card {
    let level = resistor.test.level_v;
    let drive = vec![Piece::Figure(level), Piece::Text(Words::same(" V"))];
    let measure = Step {
        name: "coil",
        what: Words::of(
            "Measure the resistance between the coil pins",
            "测量线圈引脚间电阻",
        ),
        tooling: Words::of("I-7017F, coil supply", "I-7017F、线圈电源"),
        drive: drive.clone(),
        demand: Demand::Within(vec![Parameter::Resistance.into()]),
    };
    Card {
        rating: (Words::of("Test voltage", "测试电压"), drive),
        steps: vec![Step::load(), Step::clamp(), measure, Step::sort()],
        counts: Vec::new(),
    }
}
