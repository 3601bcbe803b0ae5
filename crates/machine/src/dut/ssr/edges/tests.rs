//! Edges of records with known edges: noise, steps of the converter, edges between samples.
#![allow(clippy::unwrap_used)]

use super::*;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

/// A control pulse of 5 V and an output of 8 V that follows it, with what the digitizer makes of them.
#[derive(Clone, Copy)]
struct Record {
    step_s: f64,
    rise_s: f64,
    fall_s: f64,
    /// Time from the rise to 90 % of the load voltage.
    on_s: f64,
    /// Time from the fall to 10 % of the load voltage.
    off_s: f64,
    /// Length of an edge of the output.
    edge_s: f64,
    noise_v: f64,
    bits: u32,
    seed: u64,
}

const CLEAN: Record = Record {
    step_s: 5e-6,
    rise_s: 501.3e-6,
    fall_s: 2501.3e-6,
    on_s: 321.7e-6,
    off_s: 187.2e-6,
    edge_s: 40e-6,
    noise_v: 0.0,
    bits: 16,
    seed: 1,
};

const COUNT: usize = 1000;
const SOURCE_V: f64 = 8.0;
const DROP_V: f64 = 0.002;

impl Record {
    /// Returns the load voltage as a share of its final value.
    fn load(&self, at_s: f64) -> f64 {
        let on = (at_s - self.rise_s - self.on_s) / self.edge_s + 0.9;
        let off = 0.1 - (at_s - self.fall_s - self.off_s) / self.edge_s;
        on.clamp(0.0, 1.0).min(off.clamp(0.0, 1.0))
    }

    fn waveforms(&self) -> (Waveform, Waveform) {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(self.seed);
        let mut noise = || {
            let twelve: u64 = (0..12).map(|_| u64::from(random.next_u32())).sum();
            self.noise_v * (twelve as f64 / f64::from(u32::MAX) - 6.0)
        };
        let lsb_v = 20.0 / 2f64.powi(self.bits as i32);
        let mut channel = |volts: &dyn Fn(f64) -> f64| Waveform {
            start_s: 0.0,
            step_s: self.step_s,
            volts: (0..COUNT)
                .map(|at| volts(at as f64 * self.step_s) + noise())
                .map(|volts| ((volts / lsb_v).round() * lsb_v) as f32)
                .collect(),
        };
        let pulse = |at_s: f64| f64::from(u8::from((self.rise_s..self.fall_s).contains(&at_s)));
        let control = channel(&|at_s| 5.0 * pulse(at_s));
        let output = channel(&|at_s| SOURCE_V - (SOURCE_V - DROP_V) * self.load(at_s));
        (control, output)
    }

    fn edges(&self) -> Option<Edges> {
        let (control, output) = self.waveforms();
        edges(&control, &output)
    }

    /// Returns the errors of both times and their standard uncertainties, s.
    fn errors(&self) -> [(f64, f64); 2] {
        let edges = self.edges().unwrap();
        let sample_s = self.step_s / 6f64.sqrt();
        let one = |control: Crossing, output: Crossing, true_s: f64| {
            let u_s = sample_s.hypot(output.u_s).hypot(control.u_s);
            (output.at_s - control.at_s - true_s, u_s)
        };
        [
            one(edges.rise, edges.on.unwrap(), self.on_s),
            one(edges.fall, edges.off.unwrap(), self.off_s),
        ]
    }
}

#[test]
fn an_edge_between_two_samples_stays_within_one_interval() {
    for part in 0..20 {
        let shift_s = f64::from(part) / 20.0 * CLEAN.step_s;
        let record = Record {
            rise_s: CLEAN.rise_s + shift_s,
            on_s: CLEAN.on_s + 0.37 * shift_s,
            ..CLEAN
        };
        for (error_s, _) in record.errors() {
            assert!(error_s.abs() < record.step_s, "{part}: {error_s:e}");
        }
    }
}

#[test]
fn a_jump_lies_in_the_middle_of_its_interval() {
    let errors = (0..40_u32).map(|part| Record {
        rise_s: CLEAN.rise_s + CLEAN.step_s * (f64::from(part) * 0.618).fract(),
        fall_s: CLEAN.fall_s + CLEAN.step_s * (f64::from(part) * 0.377).fract(),
        on_s: CLEAN.on_s + CLEAN.step_s * (f64::from(part) * 0.271).fract(),
        off_s: CLEAN.off_s + CLEAN.step_s * (f64::from(part) * 0.839).fract(),
        edge_s: 1e-9,
        ..CLEAN
    });
    let errors: Vec<f64> = errors.flat_map(|it| it.errors()).map(|it| it.0).collect();
    let mean_s = errors.iter().sum::<f64>() / errors.len() as f64;
    assert!(mean_s.abs() < 0.1 * CLEAN.step_s, "{mean_s:e}");
    assert!(errors.iter().all(|it| it.abs() <= 1.01 * CLEAN.step_s));
}

#[test]
fn uncertainties_cover_noise_and_converter_steps() {
    for (bits, noise_v) in [(8, 0.0), (8, 0.03), (12, 0.0), (12, 0.01), (12, 0.05)] {
        let records = (0..100_u64).map(|seed| Record {
            bits,
            noise_v,
            seed,
            rise_s: CLEAN.rise_s + CLEAN.step_s * (seed as f64 * 0.618).fract(),
            fall_s: CLEAN.fall_s + CLEAN.step_s * (seed as f64 * 0.377).fract(),
            ..CLEAN
        });
        let errors: Vec<(f64, f64)> = records.flat_map(|it| it.errors()).collect();
        let covered = errors.iter().filter(|(error, u)| error.abs() < 2.0 * u);
        let covered = covered.count();
        assert!(covered >= 190, "{bits} bits, {noise_v} V: {covered} of 200");
    }
}

#[test]
fn gain_and_offset_of_the_digitizer_cancel() {
    let (control, mut output) = CLEAN.waveforms();
    for volts in &mut output.volts {
        *volts = 1.02 * *volts - 0.15;
    }
    let (erring, exact) = (edges(&control, &output).unwrap(), CLEAN.edges().unwrap());
    let moved_s = erring.on.unwrap().at_s - exact.on.unwrap().at_s;
    assert!(moved_s.abs() < 1e-8, "{moved_s:e}");
}

#[test]
fn an_output_that_turns_on_after_the_pulse_is_not_on() {
    let late = Record {
        on_s: 2100e-6,
        ..CLEAN
    };
    let edges = late.edges().unwrap();
    assert_eq!((edges.on, edges.off), (None, None));
}

#[test]
fn an_output_on_at_the_end_is_not_off() {
    let stuck = Record {
        off_s: 1.0,
        ..CLEAN
    };
    let edges = stuck.edges().unwrap();
    assert!(edges.on.is_some());
    assert_eq!(edges.off, None);
}

#[test]
fn a_stray_sample_is_no_crossing() {
    let (control, mut output) = CLEAN.waveforms();
    let at = (CLEAN.rise_s / CLEAN.step_s) as usize + 20;
    output.volts[at] = 0.0;
    let found = edges(&control, &output).unwrap().on.unwrap();
    assert_eq!(found.at_s, CLEAN.edges().unwrap().on.unwrap().at_s);
}

#[test]
fn a_record_without_whole_pulse_has_no_edges() {
    let none = Record {
        rise_s: 1.0,
        fall_s: 2.0,
        ..CLEAN
    };
    let endless = Record {
        fall_s: 2.0,
        ..CLEAN
    };
    let early = Record {
        rise_s: -1.0,
        ..CLEAN
    };
    let noisy = Record {
        noise_v: 0.05,
        ..none
    };
    for record in [none, endless, early, noisy] {
        assert_eq!(record.edges(), None);
    }
    let (control, mut output) = CLEAN.waveforms();
    output.volts[500] = f32::NAN;
    assert_eq!(edges(&control, &output), None);
    output.volts.truncate(400);
    assert_eq!(edges(&control, &output), None);
}
