//! Jumps of known records at many rates of samples and many noises.
#![allow(clippy::unwrap_used)]

use super::*;
use crate::instrument::query::Waveform;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

const PEAK_V: f64 = 325.0;
const DROP_V: f64 = 1.1;
/// A zero of the mains of each record, on a falling flank, s.
const ZERO_S: f64 = 10e-3;

fn mains_v(at_s: f64) -> f64 {
    PEAK_V * (std::f64::consts::TAU * 50.0 * at_s).sin()
}

fn fitted() -> Mains {
    let samples = (0..4000).map(|it| f64::from(it) * 10e-6);
    Mains::fit(samples.map(|it| (it, mains_v(it))), 50.0).unwrap()
}

/// Returns a record from 1 ms to 12 ms whose output jumps at a time.
fn record(step_s: f64, jump_s: f64, noise_v: f64, seed: u64) -> Waveform {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut noise = || {
        let twelve: u64 = (0..12).map(|_| u64::from(random.next_u32())).sum();
        noise_v * (twelve as f64 / f64::from(u32::MAX) - 6.0)
    };
    let start_s = 1e-3;
    let volts = (0..(11e-3 / step_s) as usize).map(|it| {
        let at_s = start_s + it as f64 * step_s;
        let line_v = mains_v(at_s);
        let on_v = DROP_V.min(line_v.abs()).copysign(line_v);
        let volts = if at_s < jump_s { line_v } else { on_v };
        (volts + noise()) as f32
    });
    Waveform {
        start_s,
        step_s,
        volts: volts.collect(),
    }
}

#[test]
fn the_jump_is_found_at_every_rate_and_noise() {
    let mains = fitted();
    for step_s in [0.5e-6, 1e-6, 2e-6, 4e-6, 10e-6, 20e-6] {
        for (noise_v, seed) in [0.0, 0.02, 0.3, 0.5].into_iter().zip(1..) {
            for before_zero_s in [60e-6, 100e-6, 117e-6, 150e-6, 3e-3, 5e-3] {
                // Never at a sample itself, whose side rounding would choose.
                let jump_s = ((ZERO_S - before_zero_s) / step_s).floor() * step_s + 0.3 * step_s;
                let record = record(step_s, jump_s, noise_v, seed);
                let channel = Channel::of(&record, 1.0, 0.0).unwrap();
                let behind = channel.index(jump_s);
                let back = (130e-6 / step_s) as usize;
                let range = (behind - back, behind + 1);
                let found = jump(&channel, |it| channel.at(it), &mains, range).unwrap();
                let about = format!("{step_s} s, {noise_v} V, {before_zero_s} s before zero");
                assert_eq!(found.index, behind, "{about}");
                let error_v = found.before - mains_v(found.at_s);
                assert!(error_v.abs() <= 4.0 * found.u + 0.01, "{about}: {found:?}");
            }
        }
    }
}

#[test]
fn a_mains_that_has_shifted_since_its_fit_changes_nothing() {
    let mains = fitted();
    let jump_s = ZERO_S - 110e-6;
    let mut record = record(2e-6, jump_s, 0.1, 1);
    let channel = Channel::of(&record, 1.0, 0.0).unwrap();
    let behind = channel.index(jump_s);
    // 20 us late, as the mains of one cycle may be.
    record.start_s += 20e-6;
    let channel = Channel::of(&record, 1.0, 0.0).unwrap();
    let range = (behind - 60, behind);
    let found = jump(&channel, |it| channel.at(it), &mains, range).unwrap();
    assert_eq!(found.index, behind);
    let error_v = found.before - mains_v(found.at_s - 20e-6);
    assert!(error_v.abs() < 0.1, "{found:?}");
}

#[test]
fn a_run_begins_with_its_first_sample() {
    let all = [false, true, false, true, true, true];
    assert_eq!(run_from(|it| all[it], (0, 6), 2), Some(3));
    assert_eq!(run_from(|it| all[it], (0, 5), 3), None);
}
