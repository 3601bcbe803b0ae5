//! `relayrig study transient`: the relay model of the simulated rig over cases from a file.
//!
//! The study integrates every case before it prints the first answer. Wall time is the median of [`REPEATS`]
//! integrations of the same case; all other figures are the same on any machine.
//!
//! Exit status: 0 after all cases, 2 for bad input or a case whose state diverges.

mod cases;
mod field;
#[cfg(test)]
mod tests;

use anyhow::Context;
use cases::Case;
use quality::spread::median;
use rigsim::world::relay::lumped::{Model, Outcome, Transient};
use serde_json::{Map, Value, json};
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

/// Default relative tolerance of an integration step; it gives errors of 1e-10 s on first events and 1e-8 s on last
/// bounces.
pub const USUAL_RTOL: f64 = 1e-8;
/// Number of integrations of each case; the median gives its wall time.
const REPEATS: usize = 5;

/// The answer to one case: its transient, and the wall time of the integration.
struct Answer {
    name: String,
    transient: Transient,
    wall_us: f64,
}

/// Integrates the cases of a file (`-` for standard input) and returns the text to print: a JSON line or a table per
/// case.
///
/// # Errors
/// Fails when the file cannot be read, when a field is wrong, or when the state of a case diverges.
pub fn study(file: &Path, rtol: f64, as_json: bool) -> anyhow::Result<String> {
    let text = match file == Path::new("-") {
        true => std::io::read_to_string(std::io::stdin()).context("reading standard input")?,
        false => {
            std::fs::read_to_string(file).with_context(|| format!("reading {}", file.display()))?
        }
    };
    let cases = cases::read(&text).with_context(|| file.display().to_string())?;
    let answers: Vec<Answer> = cases
        .iter()
        .map(|case| integrate(case, rtol).with_context(|| format!("case `{}`", case.name)))
        .collect::<anyhow::Result<_>>()?;
    let text = |answer: &Answer| match as_json {
        true => format!("{}\n", answer.json()),
        false => answer.text(),
    };
    Ok(answers.iter().map(text).collect())
}

fn integrate(case: &Case, rtol: f64) -> anyhow::Result<Answer> {
    let model = Model::new(&case.parameters);
    let once = || {
        let begun = Instant::now();
        let transient = model.transient(case.start, &case.excitation, case.end_s, rtol);
        transient.map(|it| (it, begun.elapsed().as_secs_f64() * 1e6))
    };
    let (transient, first_us) = once()?;
    let mut walls = vec![first_us];
    for _ in 1..REPEATS {
        walls.push(once()?.1);
    }
    Ok(Answer {
        name: case.name.clone(),
        transient,
        wall_us: median(&walls).unwrap_or(first_us),
    })
}

impl Answer {
    fn json(&self) -> Value {
        let events: Vec<Value> = self
            .transient
            .events
            .iter()
            .map(|event| json!([event.t_s, event.element.name(), u8::from(event.on)]))
            .collect();
        json!({
            "name": self.name, "results": results(&Outcome::of(&self.transient.events)), "events": events,
            "rhs_evals": self.transient.evaluations, "wall_us": self.wall_us,
        })
    }

    fn text(&self) -> String {
        let transient = &self.transient;
        let mut text = format!(
            "{}: {} events, {} evaluations, {:.0} us\n",
            self.name,
            transient.events.len(),
            transient.evaluations,
            self.wall_us
        );
        for (key, value) in results(&Outcome::of(&transient.events)) {
            if !value.is_null() {
                let _ = writeln!(text, "  {key:<24} {value}");
            }
        }
        text
    }
}

/// Returns the results under the keys of the cases file; an event that did not happen is null.
fn results(outcome: &Outcome) -> Map<String, Value> {
    let rows = [
        ("NC_first_open", json!(outcome.nc_first_open)),
        ("NC_first_make", json!(outcome.nc_first_make)),
        ("NO_first_make", json!(outcome.no_first_make)),
        ("NO_first_open", json!(outcome.no_first_open)),
        ("seat_first", json!(outcome.seat_first)),
        ("NO_last_change", json!(outcome.no_last_change)),
        ("NC_last_change", json!(outcome.nc_last_change)),
        ("NO_makes", json!(outcome.no_makes)),
        ("NC_makes", json!(outcome.nc_makes)),
        ("coil_current_first_zero", json!(outcome.coil_blocked_first)),
        ("NO_first_make_speed", json!(outcome.no_first_make_speed)),
        ("seat_first_speed", json!(outcome.seat_first_speed)),
    ];
    rows.into_iter()
        .map(|(key, value)| (key.to_owned(), value))
        .collect()
}
