//! Response of the chamber and settings of its controller, as `rack.toml` states them and `relayrig chamber` prints them.

use crate::dut::experiment::{Figure, Found};
use chamber::tune::relay::Oscillation;
use chamber::tune::{FirstOrder, Identified, Settings};
use serde::{Deserialize, Serialize};

/// Names of tables of `rack.toml`.
const RESPONSE: &str = "chamber";
const FIRST_ORDER: &str = "chamber.first_order";
const PID: &str = "chamber.pid";

/// Table `[chamber]`: the response that an identification has found, so that no batch repeats it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct StatedResponse {
    gain_k: f64,
    time_constant_s: f64,
    delay_s: f64,
    slope_k_per_s: f64,
    loss_per_k: f64,
    fan: f64,
    vent_per_k: f64,
    first_order: StatedFirstOrder,
    #[serde(default)]
    pid: Option<StatedPid>,
}

/// Table `[chamber.first_order]`: the response of the first two minutes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct StatedFirstOrder {
    gain_k: f64,
    time_constant_s: f64,
    delay_s: f64,
}

/// Table `[chamber.pid]`: settings in place of those that follow from the response.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct StatedPid {
    gain_per_k: f64,
    integral_s: f64,
    derivative_s: f64,
}

impl StatedResponse {
    /// Returns the response.
    pub fn identified(&self) -> Identified {
        let first = &self.first_order;
        Identified {
            gain_k: self.gain_k,
            time_constant_s: self.time_constant_s,
            delay_s: self.delay_s,
            slope_k_per_s: self.slope_k_per_s,
            loss_per_k: self.loss_per_k,
            fan: self.fan,
            vent_per_k: self.vent_per_k,
            first_order: FirstOrder {
                gain_k: first.gain_k,
                time_constant_s: first.time_constant_s,
                delay_s: first.delay_s,
            },
        }
    }

    /// Returns the settings of the controller; `None` when they follow from the response.
    pub fn settings(&self) -> Option<Settings> {
        self.pid.map(|it| Settings {
            gain_per_k: it.gain_per_k,
            integral_s: it.integral_s,
            derivative_s: it.derivative_s,
        })
    }
}

/// Returns the figures of a response with their standard uncertainties, under the keys of [`StatedResponse`].
pub fn figures(found: &Identified, doubt: &Identified) -> Found {
    let table = |table, all: &[(&'static str, f64, f64)]| -> Found {
        let figure = |&(key, value, u): &(&'static str, f64, f64)| Figure {
            table,
            key,
            value,
            u: Some(u),
        };
        all.iter().map(figure).collect()
    };
    let (early, unsure) = (&found.first_order, &doubt.first_order);
    let mut all = table(
        RESPONSE,
        &[
            ("gain_k", found.gain_k, doubt.gain_k),
            (
                "time_constant_s",
                found.time_constant_s,
                doubt.time_constant_s,
            ),
            ("delay_s", found.delay_s, doubt.delay_s),
            ("slope_k_per_s", found.slope_k_per_s, doubt.slope_k_per_s),
            ("loss_per_k", found.loss_per_k, doubt.loss_per_k),
            ("fan", found.fan, doubt.fan),
            ("vent_per_k", found.vent_per_k, doubt.vent_per_k),
        ],
    );
    all.extend(table(
        FIRST_ORDER,
        &[
            ("gain_k", early.gain_k, unsure.gain_k),
            (
                "time_constant_s",
                early.time_constant_s,
                unsure.time_constant_s,
            ),
            ("delay_s", early.delay_s, unsure.delay_s),
        ],
    ));
    all
}

/// Returns the settings of the controller that an oscillation gives, with their standard uncertainties.
pub fn settings(found: &Oscillation) -> Found {
    let settings = found.settings();
    let gain_share = found.u_ultimate_per_k / found.ultimate_per_k;
    let time_share = found.u_period_s / found.period_s;
    let figure = |key, value: f64, share: f64| Figure {
        table: PID,
        key,
        value,
        u: Some(value * share),
    };
    vec![
        figure("gain_per_k", settings.gain_per_k, gain_share),
        figure("integral_s", settings.integral_s, time_share),
        figure("derivative_s", settings.derivative_s, time_share),
    ]
}
