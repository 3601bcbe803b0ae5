//! Checks what a recipe needs of the rig: a rack, thermometers that reach its windows, limits wider than the
//! uncertainty, rates that the heater can make.

use super::Parameter;
use super::measure::SCATTER_K;
use super::points::Points;
use super::recipe::ThermostatRecipe;
use crate::dut::Kind;
use crate::dut::device::Rig;
use crate::dut::recipe::Limits;
use crate::rig::fault::Fault;
use crate::rig::wiring::Wiring;
use chamber::budget::Calibrations;
use chamber::program::{MARGIN_K, Window};
use chamber::tune::Identified;

/// Least distance between the end of a window and the end of the range of a thermometer, K.
const RESERVE_K: f64 = 5.0;

/// Temperature of a room, C.
const ROOM_C: f64 = 23.0;

/// Least number of passes from which repeatability is judged: the three cycles of MIL-PRF-24236.
const LEAST_CYCLES: usize = 3;

/// Share of the heater that a ramp may use: the controller needs the rest, and the mains may be low.
const MOST_POWER: f64 = 0.85;

/// Returns every reason why the rig cannot perform the recipe.
pub fn faults(recipe: &ThermostatRecipe, limits: &Limits, rig: &Rig) -> Vec<Fault> {
    let points = match reach(rig) {
        Ok(points) => points,
        Err(fault) => return vec![fault],
    };
    let Some(windows) = recipe.windows(limits) else {
        return vec![open_limit(limits)];
    };
    let least = Least::of(recipe, rig);
    let mut found: Vec<Fault> = [
        Parameter::Operate,
        Parameter::Reset,
        Parameter::Differential,
    ]
    .into_iter()
    .filter_map(|of| narrow(of, limits, &least))
    .collect();
    found.extend(claimed(recipe, limits, &least));
    found.extend(too_few_passes(recipe, limits));
    found.extend(out_of_range(recipe, &windows, &points, rig.wiring));
    found.extend(rates(recipe));
    found.extend(too_fast(recipe, &windows, rig));
    found
}

fn reach(rig: &Rig) -> Result<Points, Fault> {
    let definition = Kind::Thermostat.definition();
    let of_kind =
        |expected: String| Fault::new("kind", format!("\"{}\"", definition.name), expected);
    if rig.wiring.rack().is_none() {
        let expected = "a rig with a rack: rig.toml has no [rack]".to_owned();
        return Err(of_kind(expected));
    }
    if let Some(missing) = definition.bins.iter().find(|it| !rig.wiring.has_bin(**it)) {
        let expected = format!("a rig with the lists of this kind: rack.lists lacks \"{missing}\"");
        return Err(of_kind(expected));
    }
    Points::resolve(rig.wiring).map_err(|missing| {
        let expected = "a rig with every point that its test needs";
        Fault::new("test", missing, expected)
    })
}

fn open_limit(limits: &Limits) -> Fault {
    let is_open = |of: &Parameter| {
        let limit = limits.of(*of);
        limit.low.is_none() || limit.high.is_none()
    };
    let of = [Parameter::Operate, Parameter::Reset]
        .into_iter()
        .find(is_open)
        .map_or_else(String::new, |it| {
            crate::dut::Characteristic::from(it).to_string()
        });
    let expected = "low and high: they place the window of the passes";
    Fault::new(format!("limits.{of}"), "an open side", expected)
}

/// Least expanded uncertainty of a temperature on this rig.
struct Least {
    calibrations: Calibrations,
    fit_k: f64,
    why: &'static str,
}

impl Least {
    fn of(recipe: &ThermostatRecipe, rig: &Rig) -> Self {
        let (calibrations, why) = match rig.certificate {
            Some(certificate) => (
                certificate.remaining(),
                "by the certificate of thermometer and sockets, and the scatter of a switching",
            ),
            None => (
                Calibrations::default(),
                "without calibration of chain and sockets",
            ),
        };
        Self {
            calibrations,
            fit_k: SCATTER_K / (recipe.test.passes.max(1) as f64).sqrt(),
            why,
        }
    }

    /// Returns U of a characteristic about a value, K.
    fn u_k(&self, of: Parameter, value: f64) -> f64 {
        let budget = match of {
            Parameter::Differential => self.calibrations.of_differential(value, self.fit_k),
            Parameter::Operate
            | Parameter::Reset
            | Parameter::Contact
            | Parameter::Creep
            | Parameter::Chatter
            | Parameter::Repeatability => {
                self.calibrations.of_temperature(value - ROOM_C, self.fit_k)
            }
        };
        budget.expanded_k()
    }
}

/// Returns the fault of limits between which the guard bands leave nothing.
fn narrow(of: Parameter, limits: &Limits, least: &Least) -> Option<Fault> {
    let limit = limits.of(of);
    let (low, high) = limit.low.zip(limit.high)?;
    let u_k = least.u_k(of, f64::midpoint(low, high));
    let expected = format!(
        "limits more than {:.2} K apart: U is {u_k:.2} K {}",
        2.0 * u_k,
        least.why
    );
    let key = format!("limits.{}", crate::dut::Characteristic::from(of));
    (high - low <= 2.0 * u_k).then(|| Fault::new(key, format!("{low} to {high}"), expected))
}

/// Returns the fault of a claimed uncertainty that the rig cannot keep.
fn claimed(recipe: &ThermostatRecipe, limits: &Limits, least: &Least) -> Option<Fault> {
    let claimed_k = recipe.test.claimed_u_k?;
    let middle = |of: Parameter| {
        let limit = limits.of(of);
        Some(f64::midpoint(limit.low?, limit.high?))
    };
    let u_k = [Parameter::Operate, Parameter::Reset]
        .into_iter()
        .filter_map(|of| Some(least.u_k(of, middle(of)?)))
        .fold(0.0, f64::max);
    let expected = format!("at least {u_k:.2} K {}", least.why);
    (claimed_k < u_k).then(|| Fault::new("test.claimed_u_k", claimed_k, expected))
}

/// Returns the fault of a limit of the repeatability in batches whose few passes show no scatter.
fn too_few_passes(recipe: &ThermostatRecipe, limits: &Limits) -> Option<Fault> {
    let test = &recipe.test;
    let is_judged = !limits.of(Parameter::Repeatability).is_open();
    (is_judged && test.least_passes() < LEAST_CYCLES).then(|| {
        let expected = format!(
            "at least {}: with a limit of repeatability_k each batch needs {LEAST_CYCLES} passes, and test.passes is {}",
            LEAST_CYCLES.saturating_sub(test.passes),
            test.passes
        );
        Fault::new("test.scatter_passes", test.scatter_passes, expected)
    })
}

/// Returns the fault of a window that a thermometer of the chamber does not reach, or that leaves no room for its ramp.
fn out_of_range(
    recipe: &ThermostatRecipe,
    windows: &[Window; 2],
    points: &Points,
    wiring: &Wiring,
) -> Option<Fault> {
    let fastest = recipe
        .test
        .learning_k_per_min
        .max(recipe.test.rate_k_per_min);
    let reach_k = MARGIN_K + fastest / 60.0 * recipe.part.lag_s;
    let [operate, reset] = windows;
    let (most_c, least_c) = (operate.high_c + reach_k, reset.low_c - reach_k);
    let unlock_c = wiring.rack().map_or(0.0, |it| it.unlock_below.0);
    for thermometer in [points.control, points.reference] {
        let module = wiring.module(wiring.temperature(thermometer).module);
        let Some(scale) = module.type_code.full_scale() else {
            continue;
        };
        if most_c > scale.high - RESERVE_K {
            let key = "limits.operate_temperature_c.high";
            let expected = format!(
                "a window that ends below {:.0} C, the range of {} less a reserve of {RESERVE_K} K; it ends at {most_c:.1} C",
                scale.high - RESERVE_K,
                module.name
            );
            let limit = operate.high_c - recipe.test.beyond_k;
            return Some(Fault::new(key, limit, expected));
        }
    }
    let coldest_c = 0.8 * unlock_c;
    (least_c < coldest_c).then(|| {
        let expected = format!(
            "a window that ends above {coldest_c:.0} C, which the vent still reaches; it ends at {least_c:.1} C"
        );
        let limit = reset.low_c + recipe.test.beyond_k;
        Fault::new("limits.reset_temperature_c.low", limit, expected)
    })
}

/// Returns the faults of rates: passes at a single rate, which reveal no lag, or a slope limit without room for
/// control.
fn rates(recipe: &ThermostatRecipe) -> Vec<Fault> {
    let test = &recipe.test;
    let room = test
        .most_k_per_min
        .filter(|most| *most < 1.1 * test.rate_k_per_min);
    let room = room.map(|most| {
        let expected = format!(
            "at most {:.2}: the slope of a minute swings by a tenth about the rate, and most_k_per_min is {most}",
            most / 1.1
        );
        Fault::new("test.rate_k_per_min", test.rate_k_per_min, expected)
    });
    let slow = (test.learning_k_per_min < test.rate_k_per_min).then(|| {
        let expected = format!("at least rate_k_per_min, which is {}", test.rate_k_per_min);
        Fault::new("test.learning_k_per_min", test.learning_k_per_min, expected)
    });
    room.into_iter().chain(slow).collect()
}

/// Returns the fault of a rate that the heater cannot keep up to the end of the operate window, by the response that the
/// certificate of the rack states. Without one, the batch itself finds out (`ramp_not_reached`).
fn too_fast(recipe: &ThermostatRecipe, windows: &[Window; 2], rig: &Rig) -> Option<Fault> {
    let chamber = rig.certificate?.chamber.as_ref()?.identified();
    let [operate, _] = windows;
    let most = fastest(&chamber, operate.high_c);
    let test = &recipe.test;
    let rates = [
        ("test.learning_k_per_min", test.learning_k_per_min),
        ("test.rate_k_per_min", test.rate_k_per_min),
    ];
    let (key, found) = rates.into_iter().find(|(_, rate)| *rate > most)?;
    let expected = format!(
        "at most {most:.1} K/min: at {:.0} C the heater of this chamber makes no faster ramp with {:.0} % of its power",
        operate.high_c,
        100.0 * MOST_POWER
    );
    Some(Fault::new(key, found, expected))
}

/// Returns the fastest steady ramp of a chamber at a temperature, K/min.
fn fastest(chamber: &Identified, celsius: f64) -> f64 {
    let holds = chamber.loss_per_k * (celsius - ROOM_C) - chamber.fan;
    60.0 * chamber.slope_k_per_s * (MOST_POWER - holds).max(0.0)
}
