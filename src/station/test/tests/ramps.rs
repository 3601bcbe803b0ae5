//! One ramp after another: where the supply stands when the next one begins.

use super::super::{operate_fine, release};
use super::{PULLED, RESTING, at_23_c, bench, watched};
use crate::gauge::threshold::Direction;
use crate::rig::point::DigitalOut;
use crate::station::act::Act;
use crate::station::supply::Supply;
use crate::station::test::ramp::Expected;
use crate::units::{Span, Volt};

/// Least time from the mark before these acts to the first ARM among them.
fn until_armed(acts: &[Act]) -> Span {
    let (mut before, mut passed) = (Span(0), Span(0));
    for act in acts {
        match act {
            Act::Board(outputs) if outputs.contains(&(DigitalOut::Arm, true)) => break,
            Act::Wait(time) => passed += *time,
            Act::WaitSinceMark(time) => passed = passed.max(*time),
            Act::Mark => before += std::mem::take(&mut passed),
            Act::Board(_)
            | Act::Supply(_)
            | Act::Read(_)
            | Act::CoilMask(_)
            | Act::ConvertSinceMark(_)
            | Act::Until { .. } => {}
        }
    }
    before + passed
}

#[test]
fn an_operate_ramp_is_not_armed_while_the_release_ramp_before_it_still_falls() {
    for (sd_v, gate_ms) in [(0.008, 75.0), (0.025, 75.0), (0.06, 80.0)] {
        let bench = bench();
        let mut supply = Supply::new(&bench.calibration);
        let mut findings = at_23_c();
        findings.expected_release = Some(Expected::new(Volt(0.7), sd_v));
        findings.expected_operate = Some(Expected::new(Volt(6.7), 0.03));
        let way = findings.expected_release.unwrap().falling();
        release::acts_fine(&bench, &mut supply, &mut findings);
        let event = watched(true, RESTING, gate_ms);
        release::conclude_fine(&bench, &event, &mut findings, 0);
        let acts = operate_fine::acts(&bench, &mut supply, &mut findings);
        let falls_ms = (way.span.0 - 0.045) / 1.5 * 1e3 - gate_ms;
        // The word that arms and the approach take longer; a ramp stands while they do.
        let armed_ms = until_armed(&acts).as_seconds() * 1e3;
        assert!(armed_ms >= falls_ms.min(24.0), "{armed_ms} of {falls_ms}");
        assert!(sd_v < 0.02 || falls_ms > 30.0 && armed_ms >= falls_ms);
    }
}

#[test]
fn a_release_ramp_turns_the_one_before_it_round_and_prolongs_an_operate_ramp() {
    let wait_ms = |rising: bool| {
        let bench = bench();
        let mut supply = Supply::new(&bench.calibration);
        let mut findings = at_23_c();
        findings.expected_release = Some(Expected::new(Volt(2.3), 0.03));
        findings.expected_operate = Some(Expected::new(Volt(7.8), 0.02));
        if rising {
            operate_fine::acts(&bench, &mut supply, &mut findings);
            operate_fine::conclude(&bench, &watched(true, PULLED, 60.0), &mut findings, 0);
        } else {
            release::acts_fine(&bench, &mut supply, &mut findings);
            release::conclude_fine(&bench, &watched(true, RESTING, 60.0), &mut findings, 0);
        }
        until_armed(&release::acts_fine(&bench, &mut supply, &mut findings)).as_seconds() * 1e3
    };
    // A repetition from nothing to 0.15 V at 1.5 V/s; to 0.28 V from 0.2 V, of which 74 ms were still to come.
    let (falling, rising) = (wait_ms(false), wait_ms(true));
    assert!((100.0..110.0).contains(&falling), "{falling}");
    assert!((130.0..150.0).contains(&rising), "{rising}");
}
