//! Linear sweeps of the source.

use std::collections::VecDeque;

use crate::scpi::message::Unit;
use crate::scpi::status::Failure;

const VOLTS: &str = "[:SOURce#]:SWEep:VOLTage:LINear[:STEP]";
const AMPS: &str = "[:SOURce#]:SWEep:CURRent:LINear[:STEP]";

/// Greatest number of points of a sweep.
const POINTS: f64 = 1e6;

/// A sweep: the setting that it varies, its values, and the delay at each of them.
#[derive(Clone)]
pub(super) struct Sweep {
    pub(super) key: &'static str,
    pub(super) levels: VecDeque<Option<f64>>,
    pub(super) delay_us: u64,
}

impl Sweep {
    /// Checks whether a command describes a sweep.
    pub(super) fn is_in(unit: &Unit) -> bool {
        unit.matches(VOLTS).or(unit.matches(AMPS)).is_some()
    }

    /// Reads the parameters: start, stop, number of points or step, delay.
    ///
    /// # Errors
    /// Fails with the entry for the error queue.
    pub(super) fn read(unit: &Unit) -> Result<Self, Failure> {
        let (key, most) = match unit.matches(VOLTS) {
            Some(_) => ("volts", 210.0),
            None => ("amps", 1.05),
        };
        let level = |number| unit.number(number, -most, most, 0.0);
        let (from, to) = (level(0)?, level(1)?);
        let (count, step) = if unit.nodes.iter().any(|node| node == "STEP") {
            let step = unit.number(2, -2.0 * most, 2.0 * most, 0.0)?.abs();
            // The sweep ends at the last step before `to`; a step that exceeds `to` only by rounding counts.
            let steps = ((to - from).abs() / step + 1e-6).floor();
            (steps + 1.0, step.copysign(to - from))
        } else {
            let count = unit.number(2, 2.0, POINTS, 2.0)?.round();
            (count, (to - from) / (count - 1.0))
        };
        if !(2.0..=POINTS).contains(&count) {
            return Err(Failure::OUT_OF_RANGE);
        }
        let delay_s = match unit.parameters.len() {
            ..=3 => 0.0,
            _ => unit.number(3, 0.0, 1e4, 0.0)?,
        };
        let nth = |n: u64| Some(from + step * n as f64);
        Ok(Self {
            key,
            levels: (0..count as u64).map(nth).collect(),
            delay_us: (delay_s * 1e6) as u64,
        })
    }
}
