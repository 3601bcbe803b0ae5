//! Operate voltage on the coarse ramp from the pre-bias: an estimate to some 10 mV that places the fine ramp.

use super::indication::gate0;
use super::ramp::{after_coarse, stopped_at};
use super::{Bench, Findings, INTERLOCK, OFF, Ramp, Stage, board};
use crate::dut::em_relay::bins;
use crate::dut::em_relay::supply::{RAMP_MARGIN, Supply};
use crate::dut::em_relay::threshold::{Direction, indicated};
use crate::instrument::act::{Act, Read, Readings};
use crate::rig::point::DigitalIn;
use crate::rig::point::DigitalOut::{
    Arm, CoilDrive, EventNoBreak, RampMode, SelectNo, SourceOn, SourceReverse,
};
use crate::units::{Span, Volt};

/// The coarse release ramp begins so far above the highest threshold of the lot, volts.
const RELEASE_HEADROOM_V: f64 = 0.8;
/// Flux and armature are in equilibrium with the start level after this time.
pub(super) const SETTLES: Span = Span::ms(25);
/// Poll of the latch and write of the turn, at the longest.
const TURNS: Span = Span::ms(10);
/// Slowest operation after the end of a ramp that is still taken for its event.
pub(super) const LATE: Span = Span::ms(25);

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
    let takes = takes.max(std::mem::take(&mut findings.still_ramping));
    acts.extend([
        coarse,
        supply.step_to(Volt(bench.recipe.test.prebias_v)),
        board(&[(RampMode, true), (SelectNo, true), (EventNoBreak, false)]),
        Act::RampSinceMark(OFF.max(takes)),
        board(&[(CoilDrive, true)]),
        board(&[(Arm, true)]),
        Act::Read(Read::Gates),
        Act::Wait(SETTLES),
    ]);
    acts
}

pub(super) fn conclude_coarse(
    bench: &Bench,
    readings: &Readings,
    findings: &mut Findings,
) -> Option<Stage> {
    let start = findings.ramp_start?;
    if readings.seen.first() != Some(&true) {
        // It has operated at nominal voltage.
        match readings.boards.last() {
            Some(board) if board.no_closed => {
                findings.void("coarse operate ramp: contact made outside the window");
            }
            Some(_) => findings.fail(
                "operate_voltage_v high: above the coarse ramp",
                bins::VOLTAGE,
            ),
            None => findings.void("interface board not read"),
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
    let seen = findings.shown(coarse, Direction::Rising);
    findings.operate = Some(Ramp {
        coarse: seen,
        fine: None,
    });
    findings.operated = true;
    findings.still_ramping = turning(bench, coarse - start);
    let told = (seen, lag, Direction::Rising);
    after_coarse(bench, readings, findings, told).then_some(Stage::OperateFine(0))
}

/// How long the coarse ramp needs from its event back down to [`release_start`]: it has gone on while the
/// event was polled for and the turn written.
fn turning(bench: &Bench, climbed: Volt) -> Span {
    let per_s = bench.calibration.coarse_v_per_s.value;
    let over = climbed.0 + per_s * TURNS.as_seconds();
    let back = over.min(bench.recipe.test.coarse_span_v) - release_start(bench).0;
    TURNS + Span::seconds(back.abs() / per_s) + RAMP_MARGIN
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
