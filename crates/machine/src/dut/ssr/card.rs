//! Operation process card of a solid-state relay.

use super::Parameter;
use super::plan::LOAD_V;
use super::recipe::SsrRecipe;
use crate::dut::card::{Card, Demand, Piece, Step};

/// Returns the card of a recipe.
pub fn card(ssr: &SsrRecipe) -> Card {
    let (part, figure, literal) = (&ssr.part, Piece::Figure, Piece::Literal);
    let control = vec![figure(part.control_v), literal(" V")];
    let blocked = vec![figure(part.rated_v), literal(" V")];
    let load = [
        &control[..],
        &[literal(", "), figure(LOAD_V), literal(" V, 1 kΩ")],
    ]
    .concat();
    let measure = |name, text, drive, of: &[Parameter]| Step {
        name,
        text,
        drive,
        demand: Demand::Within(of.iter().map(|it| (*it).into()).collect()),
    };
    let rating = vec![
        figure(part.rated_v),
        literal(" V, "),
        figure(part.rated_a),
        literal(" A"),
    ];
    use Parameter as P;
    Card {
        rating: ("card-ssr_rating", rating),
        steps: vec![
            Step::handling("load", "card-load"),
            Step::handling("clamp", "card-clamp"),
            Step::handling("kelvin", "card-ssr_pins"),
            measure(
                "coil",
                "card-ssr_input",
                control.clone(),
                &[P::InputCurrent, P::ReverseCurrent],
            ),
            measure(
                "release_voltage",
                "card-ssr_leakage",
                blocked,
                &[P::LeakageCold, P::LeakageHot],
            ),
            measure(
                "operate_voltage",
                "card-ssr_threshold",
                load.clone(),
                &[P::TurnOnVoltage, P::TurnOffVoltage],
            ),
            measure(
                "operate_time",
                "card-ssr_time",
                load,
                &[P::TurnOnTime, P::TurnOffTime],
            ),
            measure(
                "release_time",
                "card-ssr_resistance",
                control,
                &[P::OnResistance, P::Drop, P::Drift],
            ),
            Step::handling("unclamp", "card-ssr_unclamp"),
            Step::handling("sort", "card-sort"),
        ],
        counts: Vec::new(),
    }
}
