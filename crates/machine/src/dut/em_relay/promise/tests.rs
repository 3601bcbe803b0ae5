use super::*;
use crate::dut::em_relay::Calibration;
use crate::dut::em_relay::calibration::Temperature;
use crate::dut::em_relay::recipe::CoilChannels;
use crate::dut::em_relay::tests::context;
use crate::gauge::{Deviation, Factor};

const NOISE_LSB: f64 = 0.5;

fn residuals(ratio: f64, freedom: u32) -> Residuals {
    Residuals {
        squares: ratio * f64::from(freedom),
        freedom,
        own: 1.0,
        others: 0.0,
    }
}

fn noise_used(promises: &Promises) -> f64 {
    let mut context = context();
    promises.apply(&mut context);
    context.accuracy.ai_noise_lsb
}

#[test]
fn a_disproved_promise_is_announced_once_and_used() {
    let mut promises = Promises::new(&context());
    promises.observe(Promise::AiNoise, [residuals(1.0, 200)]);
    assert!(promises.announce().is_empty());
    assert_eq!(noise_used(&promises), NOISE_LSB);
    promises.observe(Promise::AiNoise, [residuals(7.0, 200)]);
    let broken = promises.announce();
    assert!(promises.announce().is_empty());
    assert!((broken[0].seen - 2.0 * NOISE_LSB).abs() < 1e-9);
    let used = noise_used(&promises);
    assert!(used > broken[0].seen && used < 1.01 * broken[0].seen);
    promises.observe(Promise::AiNoise, [residuals(4.0, 200)]);
    assert!(promises.announce().is_empty(), "announced before");
}

/// Promises of a rig whose file promises this noise, with a stored calibration that has disproved [`NOISE_LSB`].
fn stored(ai_noise_lsb: f64) -> Promises {
    let mut promises = Promises::new(&context());
    promises.observe(Promise::AiNoise, [residuals(4.0, 100)]);
    let mut context = context();
    context.accuracy.ai_noise_lsb = ai_noise_lsb;
    context.calibration = Arc::new(Calibration {
        broken: promises.broken(),
        ..Calibration::clone(&context.calibration)
    });
    Promises::new(&context)
}

#[test]
fn a_stored_broken_promise_stays_and_is_announced() {
    let mut later = stored(NOISE_LSB);
    assert!(noise_used(&later) > 2.0 * NOISE_LSB);
    assert_eq!(later.announce().len(), 1);
}

#[test]
fn a_wider_promise_in_the_file_ends_the_alarm() {
    let mut later = stored(3.0 * NOISE_LSB);
    assert_eq!(noise_used(&later), 3.0 * NOISE_LSB);
    assert!(later.announce().is_empty());
}

#[test]
fn a_new_calibration_begins_with_the_promises() {
    let mut promises = stored(NOISE_LSB);
    promises.restart();
    assert_eq!(noise_used(&promises), NOISE_LSB);
    assert!(promises.broken().is_empty() && promises.announce().is_empty());
}

#[test]
fn closures_that_scatter_more_widen_the_budget() {
    let mut context = context();
    let mut promises = Promises::new(&context);
    let promised = promises.promised(Promise::ClosureScatter);
    let apart = [20.0, 20.0 * (2.0 * 2f64.sqrt() * promised / 100.0).exp()];
    for _ in 0..30 {
        let residuals = closure::of_closures(&apart, promised);
        promises.observe(Promise::ClosureScatter, residuals);
    }
    promises.apply(&mut context);
    let used = context.relay.test.strategy.contact.closure_scatter_pct;
    assert!(f64::from(used) >= 2.0 * promised, "{used} %");
}

#[test]
fn part_temperature_pools_promise_and_reference_parts() {
    let mut promises = Promises::new(&context());
    let promised = promises.promised(Promise::PartMinusTrack);
    promises.observe(Promise::PartMinusTrack, [residuals(1.0, 4)]);
    let kept = promises.part_minus_track_k(50.0);
    assert!((kept.value - promised).abs() < 1e-12 && kept.freedom == 6.0);
    assert!(promises.broken().is_empty());
    promises.restart();
    promises.observe(Promise::PartMinusTrack, [residuals(25.0, 4)]);
    assert_eq!(promises.announce()[0].promise, Promise::PartMinusTrack);
    // (2 x 1 + 4 x 25) / 6
    let broken = promises.part_minus_track_k(50.0).value;
    assert!((broken - 17f64.sqrt() * promised).abs() < 1e-12, "{broken}");
}

#[test]
fn budgets_use_the_temperature_that_the_calibration_found() {
    let mut context = context();
    let accuracy = context.accuracy;
    let promised = accuracy.part_minus_track_k;
    let temperature_k = |context: &Context| context.scan_uncertainty().temperature_k;
    let with_thermometer = Deviation::known(accuracy.rtd_k.hypot(promised));
    assert_eq!(temperature_k(&context), with_thermometer);
    assert_eq!(context.part_k(), Deviation::known(promised));
    let part_k = Deviation {
        value: 0.4,
        freedom: 5.0,
    };
    Arc::make_mut(&mut context.calibration).temperature = Some(Temperature {
        part_k,
        coil: Factor::new(1.001, 0.0004),
        mean_k: 0.0,
    });
    assert_eq!(
        (temperature_k(&context), context.part_k()),
        (part_k, part_k)
    );
    let ohm = context.calibration.ohm(CoilChannels::Fine);
    assert_eq!(ohm, Factor::new(375.0 * 1.001, 375.0 * 0.0004));
}
