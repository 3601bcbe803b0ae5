//! Operation process card of a temperature relay.

use super::Parameter;
use super::recipe::ThermostatRecipe;
use crate::dut::card::{Card, Demand, Piece, Step};

/// Returns the card of a recipe.
pub fn card(recipe: &ThermostatRecipe) -> Card {
    let (figure, literal) = (Piece::Figure, Piece::Literal);
    let rate = vec![figure(recipe.test.rate_k_per_min), literal(" K/min")];
    let measure = |name, text, drive, of: &[Parameter]| Step {
        name,
        text,
        drive,
        demand: Demand::Within(of.iter().map(|it| (*it).into()).collect()),
    };
    use Parameter as P;
    Card {
        rating: ("card-thermostat_rate", rate.clone()),
        steps: vec![
            Step::handling("load", "card-thermostat_load"),
            measure(
                "kelvin",
                "card-thermostat_contact",
                Vec::new(),
                &[P::Contact],
            ),
            measure(
                "operate_voltage",
                "card-thermostat_rise",
                rate.clone(),
                &[P::Operate, P::Creep, P::Chatter],
            ),
            measure(
                "release_voltage",
                "card-thermostat_fall",
                rate,
                &[P::Reset, P::Differential, P::Repeatability],
            ),
            Step::handling("sort", "card-thermostat_unload"),
        ],
        counts: Vec::new(),
    }
}
