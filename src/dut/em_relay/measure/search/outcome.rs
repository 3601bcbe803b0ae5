//! What a trial leads to: another one, a value, a proof, or ramps after all.

use super::{AFTER_SEARCH, Next, parameter};
use crate::dut::em_relay::coil::{relative_per_kelvin, to_reference};
use crate::dut::em_relay::measure::ramp::Expected;
use crate::dut::em_relay::measure::{Bench, Findings, Stage};
use crate::dut::em_relay::readings::Readings;
use crate::dut::em_relay::threshold::Direction;
use crate::dut::verdict::Judgement;
use crate::gauge::budget::{Budget, Reading, resolution};
use crate::rig::sample::CountSample;
use crate::units::{Span, Volt};

pub(in crate::dut::em_relay::measure) fn conclude(
    bench: &Bench,
    readings: &Readings,
    findings: &mut Findings,
    direction: Direction,
) -> Option<Stage> {
    let (Some(seen), Some(mut search)) = (readings.boards.last(), findings.search) else {
        findings.void("interface board not read");
        return None;
    };
    let rising = direction == Direction::Rising;
    let next = search.after(seen.no_closed == rising);
    findings.operated = rising && seen.no_closed;
    findings.still_ramping = Span(0);
    if let Next::Try(level) = next {
        search.at = level;
        findings.search = Some(search);
        return Some(Stage::Search(direction));
    }
    findings.search = None;
    if bench.strategy(parameter(direction)).ramps() {
        return placed(bench, findings, direction, next);
    }
    match next {
        Next::Found(volts, step) => found(bench, findings, direction, volts, step, &readings.gates),
        Next::Proven => {
            let judgement = (parameter(direction), Judgement::Pass);
            findings.proven.push(judgement);
        }
        Next::Ramp if rising => return Some(Stage::OperateCoarse),
        Next::Ramp => return Some(Stage::ReleaseCoarse),
        Next::Try(_) => {}
    }
    None
}

/// The fine ramp goes where a search in its service has found the threshold.
fn placed(
    bench: &Bench,
    findings: &mut Findings,
    direction: Direction,
    next: Next,
) -> Option<Stage> {
    let Next::Found(volts, step) = next else {
        findings.void(format!(
            "{}: no threshold between the ends of the search",
            parameter(direction)
        ));
        return None;
    };
    *findings.expected(direction) = Some(near(bench, direction, volts, step));
    Some(match direction {
        Direction::Rising => Stage::OperateFine(AFTER_SEARCH),
        Direction::Falling => Stage::ReleaseFine(AFTER_SEARCH),
    })
}

/// Where a fine ramp will show a threshold that levels have found.
fn near(bench: &Bench, direction: Direction, volts: Volt, step: Volt) -> Expected {
    let lag = match direction {
        Direction::Rising => bench.operate_lag(),
        Direction::Falling => bench.release_lag(),
    };
    Expected::new(volts + Volt(lag.fine_v.value), step.0.abs().max(0.010))
}

fn found(
    bench: &Bench,
    findings: &mut Findings,
    direction: Direction,
    volts: Volt,
    step: Volt,
    samples: &[[CountSample; 2]],
) {
    let Some(part) = findings.track else { return };
    *findings.expected(direction) = Some(near(bench, direction, volts, step));
    let value = volts.0 * to_reference(part, bench.reference_temperature());
    let (level, kelvin) = (bench.calibration.level, bench.accuracy.part_minus_track_k);
    let budget = Budget::default()
        .with("level", (value * level.gain.u).hypot(level.offset_v.u))
        .with(
            "coil temperature",
            value * kelvin * relative_per_kelvin(part),
        )
        .with("probe contact", value * bench.contact_share())
        .with("strategy", resolution(step.0))
        .with_random("repeatability", bench.operation_v());
    let reading = Reading { value, budget };
    findings.found(parameter(direction), reading, samples.iter().flatten());
}
