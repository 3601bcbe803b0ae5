//! Operate voltage: a coarse ramp from the pre-bias finds it to some 10 mV, a fine ramp around that
//! estimate measures it.
//!
//! Between both the relay drops. The approach has two steps (0.93 of the start, then the start) because
//! a step from zero picks up some 30 mV below the quasi-static threshold: the armature swings over.

use super::ramp::{self, Expected, Met, stopped_at};
use super::search::{AFTER_SEARCH, Search};
use super::{Bench, Findings, INTERLOCK, OFF, Ramp, Stage, board};
use crate::gauge::budget::Reading;
use crate::gauge::calibration::Lag;
use crate::gauge::coil::to_reference;
use crate::gauge::strategy::{from_two_rates, growth_s};
use crate::gauge::threshold::{Direction, RampDoubt, indicated, quasi_static};
use crate::gauge::timing::counts;
use crate::gauge::verdict::Bin;
use crate::gauge::{Parameter, Strategy};
use crate::rig::point::DigitalIn;
use crate::rig::point::DigitalOut::{
    Arm, CoilDrive, EventNoBreak, RampMode, SelectNo, SourceOn, SourceReverse,
};
use crate::station::act::{Act, Read, Readings};
use crate::station::supply::{RAMP_MARGIN, Supply};
use crate::units::{Celsius, Second, Span, Volt};

/// The coarse release ramp begins so far above the highest threshold of the lot, volts.
const RELEASE_HEADROOM_V: f64 = 0.8;
/// First step of the approach, as a fraction of the start of the fine ramp.
pub(super) const APPROACH: f64 = 0.93;
/// Time at the first step.
pub(super) const APPROACH_TIME: Span = Span::ms(12);
/// Flux and armature are in equilibrium with the start level after this time.
pub(super) const SETTLES: Span = Span::ms(25);
/// The same from 0.93 of it: a smaller step, and what is left of it golden parts show as well.
const FINE_SETTLES: Span = Span::ms(20);
/// Scatter of a repeated fine ramp around the first, volts.
pub(super) const REPEAT_SD_V: f64 = 0.008;
/// Poll of the latch and write of the turn, at the longest.
const TURNS: Span = Span::ms(10);
/// Slowest operation after the end of a ramp that is still taken for its event.
const LATE: Span = Span::ms(25);

/// Height of the coarse output at which the release ramp begins.
pub(super) fn release_start(bench: &Bench) -> Volt {
    let test = &bench.recipe.test;
    let above = test.expected_release_v + 4.0 * test.expected_release_sd_v + RELEASE_HEADROOM_V;
    Volt(above.min(test.coarse_span_v))
}

/// The board was armed while the coil was converted. Once the contact has made, the ramp turns round to
/// where the release begins; the armature stays.
pub(super) fn acts_coarse(bench: &Bench, supply: &mut Supply, findings: &mut Findings) -> Vec<Act> {
    let mut acts = if std::mem::take(&mut findings.armed) {
        Vec::new()
    } else {
        prepared(bench, supply, findings)
    };
    findings.ramp_start = Some(supply.total());
    findings.ramp_span = Some(Volt(bench.recipe.test.coarse_span_v) - supply.coarse());
    let (ramp, takes) = supply.ramp_coarse(Volt(bench.recipe.test.coarse_span_v));
    let (turn, _) = supply.ramp_coarse(release_start(bench));
    acts.extend([
        ramp,
        Act::Until {
            point: DigitalIn::Latch,
            within: takes + LATE,
        },
        Act::Mark,
        turn,
        Act::Read(Read::Gate),
    ]);
    acts
}

/// From rest at the pre-bias, armed: what the coil stage leaves behind, when another stage came between.
fn prepared(bench: &Bench, supply: &mut Supply, findings: &mut Findings) -> Vec<Act> {
    let mut acts = dropped(findings);
    let (coarse, takes) = supply.ramp_coarse(Volt(0.0));
    acts.extend([
        coarse,
        supply.step_to(Volt(bench.recipe.test.prebias_v)),
        board(&[(RampMode, true), (SelectNo, true), (EventNoBreak, false)]),
        Act::WaitSinceMark(OFF.max(takes)),
        board(&[(CoilDrive, true)]),
        board(&[(Arm, true)]),
        Act::Read(Read::Gates),
        Act::Wait(SETTLES),
    ]);
    acts
}

/// Length of gate 0 between the last two readings.
pub(super) fn gate0(bench: &Bench, readings: &Readings) -> Option<Second> {
    let [.., before, after] = readings.gates.as_slice() else {
        return None;
    };
    let gate = f64::from(counts(before[0].count, after[0].count)) / bench.clock().hz;
    Some(Second(
        gate - bench.calibration.gate_delay_us[0].value * 1e-6,
    ))
}

pub(super) fn conclude_coarse(
    bench: &Bench,
    readings: &Readings,
    findings: &mut Findings,
) -> Option<Stage> {
    let start = findings.ramp_start?;
    if readings.seen.first() != Some(&true) {
        let pulled = readings.boards.last().is_some_and(|board| board.no_closed);
        if pulled {
            findings.void("coarse operate ramp: contact made outside the window");
        } else {
            return Some(Stage::PullIn);
        }
        return None;
    }
    let Some(gate) = gate0(bench, readings) else {
        findings.void("gate counters not read");
        return None;
    };
    let seen = indicated(
        start,
        bench.calibration.coarse_v_per_s.value,
        gate,
        Direction::Rising,
    );
    let coarse = findings
        .ramp_span
        .and_then(|span| stopped_at(start, span, seen))
        .unwrap_or(seen);
    let lag = bench.operate_lag();
    findings.operate = Some(Ramp { coarse, fine: None });
    findings.operated = true;
    findings.still_ramping = turning(bench, coarse - start);
    findings.expected_operate = Some(Expected::new(coarse - Volt(lag.coarse_v), lag.coarse_sd_v));
    let strategy = bench.strategy(Parameter::OperateVoltage);
    if strategy.trusts_coarse()
        && let Some(part) = findings.track
    {
        let fast = FastRamp {
            seen: coarse,
            gate,
            lag,
        };
        let reading = fast.reading(bench, part);
        findings.found(
            Parameter::OperateVoltage,
            reading,
            readings.gates.iter().flatten(),
        );
    }
    (!strategy.ramps()).then_some(Stage::OperateFine(0))
}

/// A coarse ramp whose lag golden parts and lot have taught.
pub(super) struct FastRamp {
    /// Indicated voltage.
    pub seen: Volt,
    /// Length of the gate.
    pub gate: Second,
    /// Lag of this direction.
    pub lag: Lag,
}

impl FastRamp {
    /// The threshold, with the scatter of the lag in its budget.
    pub(super) fn reading(&self, bench: &Bench, part: Celsius) -> Reading {
        let as_fine = self.seen - Volt(self.lag.coarse_v);
        let doubt = RampDoubt {
            slope: bench.calibration.coarse_v_per_s,
            slope_known: true,
            ..doubt(bench)
        };
        let reference = bench.reference_temperature();
        let mut reading = quasi_static(as_fine, self.gate, self.lag, part, reference, doubt);
        reading.budget = reading.budget.with_random("strategy", self.lag.coarse_u_v);
        reading
    }
}

/// How long the coarse ramp needs from its event back down to [`release_start`]: it has gone on while the
/// event was polled for and the turn written.
fn turning(bench: &Bench, climbed: Volt) -> Span {
    let per_s = bench.calibration.coarse_v_per_s.value;
    let over = climbed.0 + per_s * TURNS.as_seconds();
    let back = over.min(bench.recipe.test.coarse_span_v) - release_start(bench).0;
    TURNS + Span::seconds(back.abs() / per_s) + RAMP_MARGIN
}

/// Nominal voltage, to tell a stuck contact from a threshold above the coarse ramp.
pub(super) fn acts_pull_in(bench: &Bench, supply: &mut Supply) -> Vec<Act> {
    vec![
        supply.step_to(Volt(bench.recipe.part.nominal_v)),
        board(&[(CoilDrive, true)]),
        Act::Wait(Span::ms(40)),
        Act::Read(Read::Board),
    ]
}

pub(super) fn conclude_pull_in(readings: &Readings, findings: &mut Findings) -> Option<Stage> {
    match readings.boards.first() {
        Some(board) if board.no_closed => {
            findings.fail(
                "operate_voltage_v high: above the coarse ramp",
                Bin::Voltage,
            );
        }
        Some(board) if board.nc_closed => {
            findings.fail(
                "contact stuck: NC does not open at nominal voltage",
                Bin::Contact,
            );
        }
        Some(_) => findings.fail(
            "contact stuck: NO does not make at nominal voltage",
            Bin::Contact,
        ),
        None => findings.void("interface board not read"),
    }
    None
}

pub(super) fn acts_fine(bench: &Bench, supply: &mut Supply, findings: &mut Findings) -> Vec<Act> {
    let repeated = findings
        .operate
        .and_then(|ramp| ramp.fine)
        .map(|fine| Expected::new(fine, REPEAT_SD_V));
    let Some(expected) = repeated.or(findings.expected_operate) else {
        return Vec::new();
    };
    findings.expected_operate = Some(expected);
    let placed = expected.placed(Direction::Rising);
    let mut acts = dropped(findings);
    acts.extend(make_room(bench, supply, placed.start));
    let approach = placed.start * APPROACH;
    acts.extend([
        supply.step_to(approach),
        board(&[(RampMode, true), (SelectNo, true), (EventNoBreak, false)]),
        Act::WaitSinceMark(OFF),
        board(&[(CoilDrive, true)]),
        Act::Wait(APPROACH_TIME),
        supply.step_to(placed.start),
        Act::Mark,
        board(&[(Arm, true)]),
        Act::Read(Read::Gates),
        Act::WaitSinceMark(FINE_SETTLES),
    ]);
    findings.ramp_start = Some(supply.total());
    findings.ramp_span = Some(placed.span);
    let (ramp, takes) = supply.jump_and_ramp(ramp::JUMP, placed.span - ramp::JUMP);
    findings.ramp_takes = takes;
    acts.extend([
        ramp,
        Act::Until {
            point: DigitalIn::Latch,
            within: takes + LATE,
        },
        Act::Mark,
        Act::Read(Read::Gate),
    ]);
    acts
}

/// Drive off, unless the stage before has switched it off already; [`OFF`] counts from the mark.
pub(super) fn dropped(findings: &mut Findings) -> Vec<Act> {
    if std::mem::take(&mut findings.released) {
        return Vec::new();
    }
    findings.operated = false;
    let off = [
        (SourceOn, false),
        (SourceReverse, false),
        (CoilDrive, false),
        (Arm, false),
    ];
    vec![board(&off), Act::Wait(INTERLOCK), Act::Mark]
}

/// Takes the ramps back when they stand higher than the approach needs, or the fine one stands at all.
fn make_room(bench: &Bench, supply: &mut Supply, start: Volt) -> Vec<Act> {
    let mut acts = Vec::new();
    let mut wait = Span(0);
    if supply.fine() > Volt(0.02) {
        let (fine, takes) = supply.ramp_fine(Volt(0.0));
        acts.push(fine);
        wait = takes;
    }
    let room = (start.0 * APPROACH - 0.3).clamp(0.0, bench.recipe.test.coarse_span_v);
    if supply.coarse().0 > room + 0.05 {
        let (coarse, takes) = supply.ramp_coarse(Volt(room));
        acts.push(coarse);
        wait = wait.max(takes);
    }
    if wait > Span(0) {
        acts.push(Act::Wait(wait));
    }
    acts
}

pub(super) fn conclude_fine(
    bench: &Bench,
    readings: &Readings,
    findings: &mut Findings,
    attempt: u8,
) -> Option<Stage> {
    let (seen, gate) = match ramp::meet(bench, readings, findings, Direction::Rising, attempt)? {
        Met::At(seen, gate) => (seen, gate),
        Met::Again => return Some(again(bench, findings, Direction::Rising, attempt)),
    };
    findings.operated = true;
    findings.still_ramping = Span(
        findings
            .ramp_takes
            .0
            .saturating_sub(Span::seconds(gate.0).0),
    );
    let part = findings.track?;
    if findings.operate.is_none_or(|ramp| ramp.fine.is_none()) {
        findings.forget(Parameter::OperateVoltage);
    }
    match &mut findings.operate {
        Some(ramp) => ramp.fine = Some(seen),
        None => findings.operate = Some(Ramp::fine_only(seen)),
    }
    let ramps = findings.operate?;
    let reading = fine_reading(bench, (ramps, gate), part, Direction::Rising);
    let samples: Vec<_> = readings.gates.iter().flatten().collect();
    findings.found(Parameter::OperateVoltage, reading, samples);
    None
}

/// After a first miss the neighbour is tried, after a second the threshold is searched by halves.
pub(super) fn again(
    bench: &Bench,
    findings: &mut Findings,
    direction: Direction,
    attempt: u8,
) -> Stage {
    if attempt + 1 == AFTER_SEARCH {
        findings.search = Some(Search::placing(bench, direction));
        return Stage::Search(direction);
    }
    match direction {
        Direction::Rising => Stage::OperateFine(attempt + 1),
        Direction::Falling => Stage::ReleaseFine(attempt + 1),
    }
}

/// Threshold from a fine ramp: less the lag of golden parts, or, by two rates, from both ramps.
pub(super) fn fine_reading(
    bench: &Bench,
    (ramps, gate): (Ramp, Second),
    part: Celsius,
    direction: Direction,
) -> Reading {
    let (lag, parameter) = match direction {
        Direction::Rising => (bench.operate_lag(), Parameter::OperateVoltage),
        Direction::Falling => (bench.release_lag(), Parameter::ReleaseVoltage),
    };
    let seen = ramps.fine.unwrap_or(Volt(f64::NAN));
    let reference = bench.reference_temperature();
    let mut reading = quasi_static(seen, gate, lag, part, reference, doubt(bench));
    if bench.strategy(parameter) == Strategy::TwoRates && ramps.coarse.0.is_finite() {
        let rates = [
            bench.calibration.coarse_v_per_s.value,
            bench.calibration.fine_v_per_s.value,
        ];
        let sign = direction.sign();
        // The growth time from the lags of both rates on golden parts; their common offset stays out of it.
        let lags = [lag.coarse_v + lag.fine_v.value, lag.fine_v.value];
        let growth = growth_s(lags.map(|it| it * sign), rates);
        let seen = [ramps.coarse.0, seen.0].map(|volts| volts * sign);
        let found = sign * from_two_rates(seen, rates, growth);
        let scatter = rates[1] / (rates[0] - rates[1]) * lag.coarse_u_v;
        reading.value = found * to_reference(part, reference);
        reading.budget = reading.budget.with_random("strategy", scatter);
    }
    reading
}

/// Doubts of a fine ramp beyond the golden parts' shift.
pub(super) fn doubt(bench: &Bench) -> RampDoubt {
    RampDoubt {
        slope: bench.calibration.fine_v_per_s,
        slope_known: false,
        operation_v: bench.accuracy.operation_scatter_mv / 1e3,
        refresh: Second(bench.accuracy.ao_refresh_ms * 1e-3),
        level: bench.calibration.level.gain.u,
        temperature_k: bench.accuracy.part_minus_track_k,
    }
}
