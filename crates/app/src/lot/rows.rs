//! Converts a judged part into rows of the history and a JSON object.

use super::LotContext;
use history::{BatchRecord, BatchSignal, CurveRecord, MeasurementRecord, PartRecord, SampleRecord};
use machine::dut::{Characteristic, Judgement, Verdict};
use machine::gauge::{Limit, Reading};
use machine::handling::ledger::PartRole;
use machine::handling::output::{EndedBatch, Judged};
use machine::instrument::trace::Trace;
use machine::rig::wiring::Wiring;
use serde_json::{Map, Value, json};
use units::RigTime;

/// Returns the number of a part among those of its kind, and the name of the kind (`lot` or `golden`).
pub fn number(role: &PartRole, reference_count: u64) -> (u64, &'static str) {
    match role {
        PartRole::Lot(seq) => (*seq, "lot"),
        PartRole::Reference(_) => (reference_count, "golden"),
    }
}

/// Returns the row of a part with its measurements and their raw replies.
pub fn part(context: &LotContext, judged: &Judged, reference_count: u64) -> PartRecord {
    let (seq, kind) = number(&judged.part.role, reference_count);
    let at = |time: RigTime| context.wall_us(time);
    PartRecord {
        lot: context.order.lot.clone(),
        seq,
        serial: match &judged.part.role {
            PartRole::Reference(serial) => Some(serial.clone()),
            PartRole::Lot(_) => judged.part.serial.clone(),
        },
        verdict: judged.verdict.name().to_string(),
        bin: judged
            .part
            .bin
            .map_or_else(String::new, |bin| bin.name().to_string()),
        reasons: judged.verdict.reasons().to_vec(),
        judged_at_us: at(judged.at),
        test_s: judged.part.test.map_or(f64::NAN, |test| test.0),
        cycle_s: None,
        landed_bin: None,
        landed_at_us: None,
        kind: kind.to_string(),
        measurements: context
            .recipe
            .limits()
            .filter_map(|of| measurement(context, judged, of))
            .collect(),
        curves: match judged.verdict {
            Verdict::Pass => Vec::new(),
            Verdict::Fail(_) | Verdict::Void(_) => {
                curves(&judged.record.trace, &context.plant.wiring, at)
            }
        },
    }
}

/// Returns the curves of the test, one per signal, in the order of the signals' first samples.
fn curves(trace: &Trace, wiring: &Wiring, at: impl Fn(RigTime) -> i64) -> Vec<CurveRecord> {
    let mut curves: Vec<CurveRecord> = Vec::new();
    for look in trace.samples() {
        let sample = (at(look.at), Some(look.value).filter(|it| it.is_finite()));
        let name = look.signal.stored_name(wiring);
        match curves.iter_mut().find(|curve| curve.signal == name) {
            Some(curve) => curve.samples.push(sample),
            None => curves.push(CurveRecord {
                signal: name,
                unit: look.signal.unit.to_owned(),
                step: look.signal.step,
                samples: vec![sample],
            }),
        }
    }
    curves
}

/// Resolution of stored air temperatures (°C) and temperature rates (K/min).
const AIR_STEP: f64 = 0.01;

/// Returns the row of a batch with its curves: set point, reference and rate, and for each socket 1 when its contact
/// opened and 0 when it closed.
pub fn batch(context: &LotContext, ended: &EndedBatch) -> BatchRecord {
    let begin_us = context.wall_us(ended.curve.origin);
    let at_us = |t_s: f64| begin_us + (t_s * 1e6).round() as i64;
    let air = &ended.curve.air;
    let of_air = |signal: &str, unit: &str, values: &mut dyn Iterator<Item = Option<f64>>| {
        let times = air.t_s.iter().map(|it| at_us(f64::from(*it)));
        BatchSignal {
            seq: None,
            curve: CurveRecord {
                signal: signal.to_owned(),
                unit: unit.to_owned(),
                step: AIR_STEP,
                samples: times.zip(values).collect(),
            },
        }
    };
    let mut signals = vec![
        of_air("set_point", "C", &mut air.set_c.iter().copied()),
        of_air(
            "reference",
            "C",
            &mut air.reference_c.iter().map(|it| Some(*it)),
        ),
        of_air("rate", "K/min", &mut air.rate_k_per_min.iter().copied()),
    ];
    signals.extend(ended.curve.switched.iter().map(|it| {
        let opened = it.opened_s.iter().map(|t| (at_us(*t), Some(1.0)));
        let closed = it.closed_s.iter().map(|t| (at_us(*t), Some(0.0)));
        let mut samples: Vec<(i64, Option<f64>)> = opened.chain(closed).collect();
        samples.sort_by_key(|(at_us, _)| *at_us);
        let part = ended.parts.iter().find(|(socket, _)| *socket == it.socket);
        BatchSignal {
            seq: part.map(|(_, seq)| *seq),
            curve: CurveRecord {
                signal: format!("socket_{}", it.socket),
                unit: String::new(),
                step: 1.0,
                samples,
            },
        }
    }));
    BatchRecord {
        lot: context.order.lot.clone(),
        number: ended.number,
        begin_us,
        ended_us: context.wall_us(ended.ended),
        signals,
    }
}

fn measurement(
    context: &LotContext,
    judged: &Judged,
    (characteristic, limit): (Characteristic, Limit),
) -> Option<MeasurementRecord> {
    let reading = judged.record.result(characteristic)?;
    let unit = characteristic.unit();
    assert_eq!(reading.unit, unit, "{characteristic} in another unit");
    assert_eq!(limit.unit, unit, "{characteristic} limited in another");
    let judgement = judged
        .judgements
        .iter()
        .find(|(known, _)| *known == characteristic)
        .map(|(_, j)| *j);
    let sample = |origin: &machine::rig::sample::Origin| SampleRecord {
        line: context.plant.wiring.line(origin.line).name.clone(),
        module: context.plant.wiring.module(origin.module).name.clone(),
        channel: origin.channel.to_string(),
        command: origin.request(),
        raw: origin.raw.to_string(),
        at_us: context.wall_us(origin.at),
    };
    Some(MeasurementRecord {
        key: characteristic.key().to_string(),
        value: Some(reading.value).filter(|value| value.is_finite()),
        uncertainty: Some(reading.expanded()).filter(|u| u.is_finite()),
        low: limit.low,
        high: limit.high,
        verdict: judgement.unwrap_or(Judgement::Void).verdict().to_owned(),
        attempt: u32::try_from(judged.record.attempts(characteristic)).unwrap_or(u32::MAX),
        budget: budget(&reading),
        samples: judged.record.evidence(characteristic).map(sample).collect(),
    })
}

/// Returns the uncertainty budget as JSON; `None` for a budget with a term that is not finite, because JSON has no
/// infinity.
fn budget(reading: &Reading) -> Option<String> {
    if !reading.expanded().is_finite() {
        return None;
    }
    serde_json::to_string(&reading.budget).ok()
}

/// Returns the part as the JSON object that `run --json` prints.
pub fn json(context: &LotContext, judged: &Judged, cycle_s: Option<f64>, bin: &str) -> Value {
    let mut values = Map::new();
    let mut uncertainty = Map::new();
    for characteristic in context.recipe.device.kind().characteristics() {
        let Some(reading) = judged.record.usable(characteristic) else {
            continue;
        };
        let key = characteristic.key();
        values.insert(key.into(), json!(rounded(reading.value)));
        uncertainty.insert(key.into(), json!(rounded(reading.expanded())));
    }
    let conforms = judged.record.conforms.iter();
    values.extend(conforms.map(|(key, conforms)| ((*key).to_owned(), json!(conforms))));
    let (seq, _) = number(&judged.part.role, 0);
    let spent = judged.record.spent;
    let mut object = json!({
        "type": "part",
        "seq": seq,
        "lot": context.order.lot,
        "recipe": context.recipe.name,
        "verdict": judged.verdict.name(),
        "bin": bin,
        "reasons": judged.verdict.texts(),
        "reason_codes": judged.verdict.reasons(),
        "values": values,
        "uncertainty": uncertainty,
        "test_s": judged.part.test.map(|test| rounded(test.0)),
        "cycle_s": cycle_s.map(rounded),
        "stages": judged.record.stages.iter().map(|(what, time)| ((*what).to_string(), json!(time.as_seconds()))).collect::<Map<String, Value>>(),
        "spent": {
            "bus_s": spent.bus.as_seconds(),
            "settling_s": spent.settling.as_seconds(),
            "conversion_s": spent.conversion.as_seconds(),
            "ramp_s": spent.ramp.as_seconds(),
            "bound_s": spent.bound.as_seconds(),
        },
    });
    if let Some(serial) = &judged.part.serial {
        object["serial"] = json!(serial);
    }
    if let Some(at) = judged.part.tested_in {
        object["socket"] = json!(at.socket);
        object["batch"] = json!(at.batch);
    }
    object
}

/// Rounds to seven significant digits, so that outputs are easy to read and compare.
pub fn rounded(value: f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    let scale = 10f64.powi(6 - value.abs().log10().floor() as i32);
    (value * scale).round() / scale
}
