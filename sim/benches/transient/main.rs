//! Accuracy of a relay transient against its cost:
//! `cargo bench -p rigsim --features peers --bench transient [-- --json]`.
//!
//! The case is a 12 V operation of the default relay, 8 ms from rest. Each scheme reports the first make and the
//! last change of NO; its error is the difference from this project's method at a tolerance of 1e-14. Wall time is
//! the median (and the 99th percentile) of many runs in this process; its ratio is to the wall time of this
//! project's method at a tolerance of 1e-6. `--json` prints the rows as figures, a line of JSON each.

mod diffsol_peer;
mod fixed_steps;

use rigsim::world::relay::lumped::{Element, Excitation, Model, Outcome, Parameters, Waveform};
use serde_json::json;
use std::time::Instant;

/// Length of the transient, s.
pub const END_S: f64 = 0.008;
/// Coil voltage, V.
pub const VOLTS: f64 = 12.0;
/// Wall-time limit of this project's method at an error of [`BAR_S`], microseconds.
const BAR_US: f64 = 300.0;
/// Greatest error of an instant of NO, s.
const BAR_S: f64 = 1e-9;

/// Changes of NO that a scheme reports.
#[derive(Clone, Copy, Default)]
pub struct NoContactTimes {
    /// First make, s.
    pub make_s: f64,
    /// Last change, s.
    pub last_s: f64,
    /// Number of changes of NO, or of all modes where the scheme reports them.
    pub events: usize,
    /// Evaluations of the equations, 0 where unknown.
    pub evaluations: u64,
}

impl NoContactTimes {
    /// Summarises the instants at which NO changes.
    pub fn of_changes(changes: &[f64], evaluations: u64) -> Self {
        Self {
            make_s: changes.first().copied().unwrap_or(f64::NAN),
            last_s: changes.last().copied().unwrap_or(f64::NAN),
            events: changes.len(),
            evaluations,
        }
    }
}

/// One row of the table.
struct Row {
    scheme: String,
    runs: usize,
    seen: NoContactTimes,
    median_us: f64,
    p99_us: f64,
}

fn measured(scheme: impl Into<String>, runs: usize, once: impl Fn() -> NoContactTimes) -> Row {
    let seen = once();
    let mut walls: Vec<f64> = (0..runs)
        .map(|_| {
            let begun = Instant::now();
            std::hint::black_box(once());
            begun.elapsed().as_secs_f64() * 1e6
        })
        .collect();
    walls.sort_by(f64::total_cmp);
    Row {
        scheme: scheme.into(),
        runs,
        seen,
        median_us: walls[runs / 2],
        p99_us: walls[(runs * 99 / 100).min(runs - 1)],
    }
}

fn own(model: &Model, rtol: f64) -> NoContactTimes {
    let Ok(waveform) = Waveform::new(vec![[0.0, VOLTS]]) else {
        return NoContactTimes::default();
    };
    let excitation = Excitation::Source(waveform);
    match model.transient(model.at_rest(0.0), &excitation, END_S, rtol) {
        Ok(run) => {
            let seen = Outcome::of(&run.events);
            NoContactTimes {
                make_s: seen.no_first_make.unwrap_or(f64::NAN),
                last_s: seen.no_last_change.unwrap_or(f64::NAN),
                events: run
                    .events
                    .iter()
                    .filter(|e| e.element == Element::No)
                    .count(),
                evaluations: run.evaluations,
            }
        }
        Err(_) => NoContactTimes::default(),
    }
}

fn main() {
    let model = Model::new(&Parameters::default());
    let truth = own(&model, 1e-14);
    let mut rows = Vec::new();
    for rtol in [1e-6, 1e-8, 1e-10, 1e-12, 1e-4] {
        rows.push(measured(format!("own DOP853, rtol {rtol:e}"), 400, || {
            own(&model, rtol)
        }));
    }
    for h_us in [10.0, 5.0, 2.0, 1.0] {
        let once = || fixed_steps::runge_kutta(&model, h_us * 1e-6);
        rows.push(measured(format!("Runge-Kutta 4, {h_us} us"), 50, once));
    }
    for h_us in [10.0, 5.0, 1.0] {
        let once = || fixed_steps::semi_implicit_euler(&model, h_us * 1e-6);
        rows.push(measured(
            format!("semi-implicit Euler, {h_us} us"),
            50,
            once,
        ));
    }
    for rtol in [1e-6, 1e-8, 1e-10] {
        let once = || diffsol_peer::tsit45(&model, rtol).unwrap_or_default();
        rows.push(measured(
            format!("diffsol tsit45 with roots, rtol {rtol:e}"),
            50,
            once,
        ));
    }
    match std::env::args().any(|word| word == "--json") {
        true => print_figures(&rows, truth),
        false => print(&rows, truth),
    }
}

/// Returns the greater error of the two instants, s.
fn error_s(row: &Row, truth: NoContactTimes) -> f64 {
    let (make, last) = (
        row.seen.make_s - truth.make_s,
        row.seen.last_s - truth.last_s,
    );
    make.abs().max(last.abs())
}

/// Prints wall time and error of every scheme; the bars apply to the first.
fn print_figures(rows: &[Row], truth: NoContactTimes) {
    for (place, row) in rows.iter().enumerate() {
        let mut line = json!({
            "type": "figure", "study": "transient", "figure": row.scheme, "n": row.runs, "value": row.median_us, "unit": "us",
            "p99_us": row.p99_us, "error_s": error_s(row, truth), "evaluations": row.seen.evaluations,
        });
        if place == 0 {
            line["bar"] = json!(format!("<= {BAR_US}"));
        }
        println!("{line}");
    }
    let own = &rows[0];
    let line = json!({
        "type": "figure", "study": "transient", "figure": format!("{}: error of the instants", own.scheme), "n": 1,
        "value": error_s(own, truth), "unit": "s", "bar": format!("<= {BAR_S}"),
    });
    println!("{line}");
}

fn print(rows: &[Row], truth: NoContactTimes) {
    println!(
        "operation at {VOLTS} V, {} ms; errors of NO in seconds",
        END_S * 1e3
    );
    println!(
        "{:<38} {:>9} {:>9} {:>6} {:>9} {:>10} {:>10} {:>8}",
        "scheme", "median us", "p99 us", "ratio", "evals", "make", "last", "changes"
    );
    for row in rows {
        println!(
            "{:<38} {:>9.1} {:>9.1} {:>6.2} {:>9} {:>10.1e} {:>10.1e} {:>8}",
            row.scheme,
            row.median_us,
            row.p99_us,
            row.median_us / rows[0].median_us,
            row.seen.evaluations,
            row.seen.make_s - truth.make_s,
            row.seen.last_s - truth.last_s,
            row.seen.events,
        );
    }
    let own = &rows[0];
    let error = error_s(own, truth);
    let met = own.median_us <= BAR_US && error <= BAR_S;
    let said = if met { "met" } else { "missed" };
    println!(
        "bar {BAR_US} us at {BAR_S:e} s: {:.1} us at {error:.1e} s: {said}",
        own.median_us
    );
}
