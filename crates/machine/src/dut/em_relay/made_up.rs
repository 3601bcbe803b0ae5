//! Statistics of made-up relays: those of the lot in the default simulated world.

use super::Parameter;
use super::parameter::Expected;
use super::points::{BOARD, COIL_VOLTAGE};
use super::recipe::RelayRecipe;
use crate::dut::made_up::{Looks, MadeUp, Scatter};
use crate::gauge::Budget;
use crate::instrument::trace::Signal;

/// Returns the scatter and the recorded signals of made-up relays.
pub fn made_up(relay: &RelayRecipe) -> MadeUp {
    let all = Parameter::ALL.into_iter();
    MadeUp {
        scatter: all.map(|it| (it.into(), of(relay, it))).collect(),
        looks: looks(),
    }
}

fn of(relay: &RelayRecipe, parameter: Parameter) -> Scatter {
    let test = &relay.test;
    let nominal_ohm = relay.part.nominal_coil_ohm;
    let (mean, sd, logarithmic, u) = match parameter.facts().expected {
        Expected::Coil => (nominal_ohm, 0.015 * nominal_ohm, false, 0.001 * nominal_ohm),
        Expected::Threshold(direction) => {
            let (mean_v, sd_v) = test.expected(direction);
            (mean_v, sd_v, false, 0.006)
        }
        Expected::Usual {
            mean,
            sd,
            logarithmic,
            u,
        } => (mean, sd, logarithmic, u),
    };
    let budget = Budget::default()
        .with_random("reading", 0.6 * u)
        .with("offset", 0.3 * u)
        .with("references", 0.2 * u)
        .with("coil temperature", 0.7 * u);
    Scatter {
        mean,
        sd,
        logarithmic,
        u,
        budget,
    }
}

/// Returns how the recorded signals look: 30 polls of a contact, 120 samples of a voltage.
fn looks() -> Vec<Looks> {
    vec![
        Looks {
            signal: Signal::bits(BOARD),
            count: 30,
            value: |n| (500 + n % 2) as f64,
        },
        Looks {
            signal: Signal::input(COIL_VOLTAGE),
            count: 120,
            value: |n| 5.0 + 0.031_7 * n as f64,
        },
    ]
}
