//! The cases file: parameters of a relay, and the excitations of its coil.
//!
//! ```text
//! parameters         SI units, T in Celsius; a missing parameter has the value of the default relay
//! mu0                optional
//! cases[].name
//!        .changed    parameters of this case that differ
//!        .s0         [flux linkage, x, v, y, w] at 0
//!        .initial    without s0: "rest", or "sealed12" for a relay that holds with 12 V
//!        .waveform   [[s, V], ...], linear between, held after; two points at one instant are a step
//!        .freewheel_clamp_V   not null: the coil switches off at 0 into this coil suppression; no waveform
//!        .t_end      s
//! ```
//!
//! The reader ignores answers in the file (`results`, `events`, `probe` ...).

use super::field::Field;
use anyhow::{Context, bail};
use rigsim::world::relay::lumped::{Excitation, LAMBDA, Model, Parameters, State, Waveform};
use serde_json::Value;

/// One transient to integrate.
#[derive(Debug)]
pub struct Case {
    /// Name of the case.
    pub name: String,
    /// Parameters of the relay.
    pub parameters: Parameters,
    /// State at time 0.
    pub start: State,
    /// Voltage or suppression at the coil.
    pub excitation: Excitation,
    /// Duration, s.
    pub end_s: f64,
}

/// Keys of a case. The reader ignores those of the second half: a note, and answers.
const KEYS: &[&str] = &[
    "name",
    "changed",
    "initial",
    "s0",
    "waveform",
    "freewheel_clamp_V",
    "t_end",
    "note",
    "results",
    "events",
    "n_events",
    "probe",
    "agree_s",
    "nfev",
];

/// Reads every case.
///
/// # Errors
/// Fails when the text is not JSON, or when a field is missing, unknown or outside its range; the error names the
/// field.
pub fn read(text: &str) -> anyhow::Result<Vec<Case>> {
    let file: Value = serde_json::from_str(text).context("expected JSON")?;
    let root = Field::root(&file);
    let mut parameters = Parameters::default();
    if let Some(mu0) = root.member("mu0")? {
        parameters.mu0 = mu0.number()?;
    }
    if let Some(all) = root.member("parameters")? {
        put(&mut parameters, &all)?;
    }
    let cases = root
        .must("cases", "a list of cases")?
        .list("a list of cases")?;
    if cases.is_empty() {
        bail!("cases: found none, expected at least one");
    }
    cases
        .iter()
        .map(|case| read_case(case, parameters))
        .collect()
}

fn read_case(case: &Field, mut parameters: Parameters) -> anyhow::Result<Case> {
    case.members(KEYS)?;
    if let Some(changed) = case.member("changed")? {
        put(&mut parameters, &changed)?;
    }
    let end = case.must("t_end", "seconds")?;
    let end_s = end.number()?;
    if end_s <= 0.0 || end_s > 100.0 {
        return Err(end.wrong("seconds above 0, at most 100"));
    }
    Ok(Case {
        name: case.must("name", "a text")?.text()?.to_owned(),
        start: start(case, &parameters)?,
        excitation: excitation(case)?,
        parameters,
        end_s,
    })
}

fn put(parameters: &mut Parameters, all: &Field) -> anyhow::Result<()> {
    let fields = all.members(Parameters::NAMES)?;
    for (name, field) in &fields {
        parameters.set(name, field.number()?);
    }
    let Some((name, expected)) = parameters.fault() else {
        return positive_ohm(parameters, all);
    };
    let own = fields.iter().find(|(known, _)| *known == name);
    Err(own.map_or(all, |(_, field)| field).wrong(expected))
}

fn positive_ohm(parameters: &Parameters, all: &Field) -> anyhow::Result<()> {
    let ohm = parameters.coil_ohm();
    if ohm <= 0.0 {
        let expected = format!("R23, alpha23 and T that give a resistance above 0, not {ohm} ohm");
        return Err(all.wrong(&expected));
    }
    Ok(())
}

fn start(case: &Field, parameters: &Parameters) -> anyhow::Result<State> {
    if let Some(s0) = case.member("s0")? {
        let state: State = s0.numbers("five numbers: flux linkage, x, v, y, w")?;
        if (state[LAMBDA] / parameters.N).abs() >= parameters.phis {
            return Err(s0.wrong("a flux linkage below saturation, N phis"));
        }
        return Ok(state);
    }
    let initial = case.must("initial", "`rest` or `sealed12`, or a state in s0")?;
    let model = Model::new(parameters);
    match initial.text()? {
        "rest" => Ok(model.at_rest(0.0)),
        text => {
            let volts = text
                .strip_prefix("sealed")
                .and_then(|v| v.parse::<f64>().ok());
            match volts.filter(|v| v.is_finite() && *v > model.release().volts) {
                Some(volts) => Ok(model.sealed(volts)),
                None => Err(initial
                    .wrong("`rest`, or `sealed` with volts above release such as `sealed12`")),
            }
        }
    }
}

fn excitation(case: &Field) -> anyhow::Result<Excitation> {
    if let Some(clamp) = case.member("freewheel_clamp_V")? {
        let volts = clamp.number()?;
        if volts < 0.0 {
            return Err(clamp.wrong("volts, 0 or more, or null"));
        }
        return Ok(Excitation::Suppression(volts));
    }
    let field = case.must("waveform", "a list of [s, V]")?;
    let list = field.list("a list of [s, V]")?;
    let points: Vec<[f64; 2]> = list
        .iter()
        .map(|point| point.numbers("[s, V]"))
        .collect::<anyhow::Result<_>>()?;
    let waveform = Waveform::new(points).map_err(|at| {
        list.get(at)
            .unwrap_or(&field)
            .wrong("[s, V] not before the point ahead of it, at least one")
    })?;
    Ok(Excitation::Source(waveform))
}
