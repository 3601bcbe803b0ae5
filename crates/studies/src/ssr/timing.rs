//! Turn-on time of a DC part from one record of control and output.

use super::scope::Scope;
use super::{Dice, row, uniform};
use crate::figure::{Bar, Figure};
use machine::dut::ssr::edges::edges as found;

/// Time to read one sample of two channels, s.
const READ_S: f64 = 1.6e-6;
/// Length of the control pulse, s.
const PULSE_S: f64 = 2e-3;
/// Length of the record, s.
const RECORD_S: f64 = 4.4e-3;
/// Begin of the record, relative to the nominal begin of the pulse, s.
const BEGINS_S: f64 = -0.44e-3;
/// Voltage of the control pulse, V.
const CONTROL_V: f64 = 5.0;
/// Voltage of the source at the output, V.
const SOURCE_V: f64 = 8.0;

/// Returns the rows of several sampling intervals.
pub fn edges(parts: u64) -> Vec<Figure> {
    [1e-6, 4e-6, 10e-6, 20e-6]
        .map(|step_s| interval(parts, step_s))
        .to_vec()
}

fn interval(parts: u64, step_s: f64) -> Figure {
    let mut dice = Dice::new(1);
    let scope = Scope { bits: 12, step_s };
    let mut errors = Vec::new();
    for _ in 0..parts {
        let rise_s = uniform(&mut dice, 0.0, step_s);
        let (on_s, off_s) = (
            uniform(&mut dice, 50e-6, 500e-6),
            uniform(&mut dice, 100e-6, 500e-6),
        );
        let is_on = |at_s: f64, from_s: f64, to_s: f64| (from_s..to_s).contains(&at_s);
        let control = |at_s: f64| {
            let is_on = is_on(at_s, rise_s, rise_s + PULSE_S);
            if is_on { CONTROL_V } else { 0.0 }
        };
        let output = |at_s: f64| {
            let is_on = is_on(at_s, rise_s + on_s, rise_s + PULSE_S + off_s);
            if is_on { 0.0 } else { SOURCE_V }
        };
        let times = (BEGINS_S, RECORD_S);
        let control = scope.record(times, 6.0, &mut dice, control);
        let output = scope.record(times, 10.0, &mut dice, output);
        let on = found(&control, &output).and_then(|it| Some((it.on?, it.rise)));
        errors.extend(on.map(|(on, rise)| 1e6 * (on.at_s - rise.at_s - on_s)));
    }
    let seconds = RECORD_S + READ_S * RECORD_S / step_s;
    let figure = row(
        format!("turn-on time, {} us a sample", 1e6 * step_s),
        &errors,
        "us",
        seconds,
    );
    match step_s < 5e-6 {
        true => figure.bar(Bar::AtMost(10.0)),
        false => figure,
    }
}
