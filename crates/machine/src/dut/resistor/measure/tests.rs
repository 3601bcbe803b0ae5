//! A resistor measured with given replies.
#![allow(clippy::unwrap_used)]

use super::*;
use crate::dut::Verdict;
use crate::dut::reason::{Code, Reason};
use crate::dut::recipe::DeviceRecipe;
use crate::gauge::Side;
use crate::handling::tests::{MockRig, wiring};
use crate::rig::bin::Bin;

const LEVEL_V: f64 = 3.9;

fn device(limits: &str) -> Device {
    let text = format!(
        "name = \"r\"\nkind = \"resistor\"\ntitle_en = \"r\"\ntitle_zh = \"r\"\n\
         [part]\nbody_mm = [22.5, 16.5, 16.5]\npin_length_mm = 3.5\nreference_temperature_c = 23.0\n\
         tcr_ppm_per_k = 25.0\n\
         [limits]\nresistance_ohm = {limits}\n\
         [decision]\nrule = \"guard_band\"\nslow_repeats = 2\n\
         [test]\nlevel_v = {LEVEL_V}\nsettles_ms = 5\nreadings = 1\n"
    );
    let recipe: Recipe = toml::from_str(&text).unwrap();
    let DeviceRecipe::Resistor(resistor) = recipe.device.clone() else {
        panic!("a resistor");
    };
    let context = crate::dut::em_relay::tests::context();
    let wiring = wiring();
    let points = Points::resolve(&wiring).unwrap();
    Device {
        channel: ChannelAccuracy {
            accuracy: context.accuracy,
            volt_per_ampere: wiring.analog_in(points.current).gain,
        },
        recipe: Arc::new(recipe),
        resistor: Arc::new(resistor),
        points,
        channels: 2,
        range: None,
    }
}

/// Tests a part of `ohm`; `None` reads over range. Returns the test and the number of readings.
fn tested(limits: &str, ohm: Option<f64>) -> (Procedure, usize) {
    let mut mock = MockRig::at_rest();
    let device = device(limits);
    let order = TestOrder {
        thorough: false,
        teaching: None,
        number: 1,
    };
    let mut test = device.begin(&order, mock.now);
    let (mut done, mut reads) = (None, 0);
    loop {
        match test.step(mock.now, done.take().as_ref(), &mock.image) {
            Progress::Judged => return (test, reads),
            Progress::Running(RunnerState::Wait(until)) => mock.now = until,
            Progress::Running(RunnerState::Job(job)) => {
                if matches!(job, crate::instrument::act::Job::Read(_)) {
                    reads += 1;
                    // Volts at the terminal: full scale reads as over range.
                    mock.volts_at(
                        device.points.current,
                        ohm.map_or(10.0, |ohm| LEVEL_V / ohm * device.channel.volt_per_ampere),
                    );
                }
                done = Some(JobDone::new(mock.now, None));
            }
            Progress::Running(RunnerState::Busy | RunnerState::Done | RunnerState::Trouble(_)) => {
                panic!("a test that waits for nothing")
            }
        }
    }
}

const LIMITS: &str = "{ low = 370.0, high = 410.0 }";

#[test]
fn a_resistor_inside_its_limits_passes_on_one_reading() {
    let (test, reads) = tested(LIMITS, Some(390.0));
    assert_eq!((test.verdict(), reads), (Verdict::Pass, 1));
    let reading = test.record().result(Parameter::Resistance).unwrap();
    assert!((reading.value - 390.0).abs() < 0.5, "{}", reading.value);
    // 0.1 % gain, 0.05 % of 10 V in 6 V, 0.05 % and 2 mV of the level: some 0.2 % in all.
    assert!((0.5..1.5).contains(&reading.expanded()), "{reading:?}");
}

#[test]
fn a_resistor_near_its_limit_is_read_again() {
    let (test, reads) = tested(LIMITS, Some(409.8));
    assert_eq!(reads, 3);
    let inconclusive = Reason::not_proven(Parameter::Resistance.into(), Side::High);
    assert_eq!(test.verdict(), Verdict::Fail(vec![inconclusive]));
}

#[test]
fn open_and_short_fail_into_the_coil_bin() {
    for (ohm, finding) in [(Some(1e7), Finding::Open), (None, Finding::Short)] {
        let (test, _) = tested(LIMITS, ohm);
        let verdict = test.verdict();
        assert_eq!(verdict.reasons()[0].code, Code::Finding(finding.into()));
        assert_eq!(verdict.bin(), Bin::named("coil"));
    }
}
