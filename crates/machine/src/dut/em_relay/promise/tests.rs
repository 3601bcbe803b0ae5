use super::*;
use crate::dut::em_relay::tests::context;

fn accuracy() -> AccuracySettings {
    context().accuracy
}

fn residuals(ratio: f64, freedom: u32) -> Residuals {
    Residuals {
        squares: ratio * f64::from(freedom),
        freedom,
        own: 1.0,
        others: 0.0,
    }
}

#[test]
fn a_disproved_promise_is_announced_once_and_used() {
    let mut promises = Promises::new(accuracy(), Vec::new());
    promises.observe(Promise::AiNoise, [residuals(1.0, 200)]);
    assert!(promises.announce().is_empty());
    assert_eq!(promises.accuracy(), accuracy());
    promises.observe(Promise::AiNoise, [residuals(7.0, 200)]);
    let broken = promises.announce();
    assert!(promises.announce().is_empty());
    assert!((broken[0].seen - 2.0 * accuracy().ai_noise_lsb).abs() < 1e-9);
    let used = promises.accuracy().ai_noise_lsb;
    assert!(used > broken[0].seen && used < 1.01 * broken[0].seen);
    promises.observe(Promise::AiNoise, [residuals(4.0, 200)]);
    assert!(promises.announce().is_empty(), "announced before");
}

#[test]
fn a_stored_broken_promise_stays_in_force_and_is_announced() {
    let mut promises = Promises::new(accuracy(), Vec::new());
    promises.observe(Promise::OperationScatter, [residuals(4.0, 100)]);
    let mut later = Promises::new(accuracy(), promises.broken().to_vec());
    assert_eq!(later.accuracy(), promises.accuracy());
    assert_eq!(later.announce(), promises.broken());
}
