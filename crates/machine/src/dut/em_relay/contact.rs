//! Contact resistance, four-wire, with the source reversed: `R = K (V+ - V-) / 2`, or with four readings
//! `K (V1 - V2 - V3 + V4) / 4`.
//!
//! The reversal cancels the thermal EMF and the converter's offset. The calibration finds `K` on the 50 mOhm reference
//! with the same source, amplifier and converter, so `K` contains the current and all gains.

use super::sampling::Polarities;
use crate::gauge::Factor;
use crate::gauge::budget::{Budget, Reading};
use units::{Unit, Volt};

/// Closure read with both polarities of the source.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Closure {
    /// Drop caused by the current, volts at the terminal.
    pub drop: Volt,
    /// Reading without current: offset and thermal EMF, volts at the terminal.
    pub zero: Volt,
    /// Number of readings in both means.
    pub readings: usize,
}

impl Closure {
    /// Evaluates readings taken with the source in the directions of `polarities`; `None` unless there is one reading
    /// for each direction.
    pub fn of(readings: &[Volt], polarities: Polarities) -> Option<Self> {
        let signs = polarities.signs();
        let n = signs.len() as f64;
        let all = readings.iter().map(|reading| reading.0).sum::<f64>();
        let turned = readings
            .iter()
            .zip(signs)
            .map(|(reading, sign)| sign * reading.0);
        (readings.len() == signs.len()).then(|| Self {
            drop: Volt(turned.sum::<f64>() / n),
            zero: Volt(all / n),
            readings: signs.len(),
        })
    }

    /// Returns the standard uncertainty of the drop, and of the zero, volts, from that of one reading, `reading_v`.
    pub fn u_v(&self, reading_v: f64) -> f64 {
        reading_v / (self.readings as f64).sqrt()
    }
}

/// Returns the standard uncertainty of the mean drop of `later + 1` closures, volts.
///
/// The first closure has `readings` readings of both polarities. The later ones have forward readings only: the zero of
/// the first closure is subtracted from them, so averaging does not reduce the noise of that zero, and the EMF may have
/// changed by `emf_v` since.
pub fn u_with_later_v(readings: usize, later: usize, reading_v: f64, emf_v: f64) -> f64 {
    let (m, k) = (readings as f64, later as f64);
    let n = k + 1.0;
    let forward = m / 2.0 * ((1.0 - k) / (m * n)).powi(2);
    let reversed = m / 2.0 / m.powi(2);
    let own = k / n.powi(2);
    (reading_v.powi(2) * (forward + reversed + own) + emf_v.powi(2) * own).sqrt()
}

/// Returns the resistance in milliohms from the drops of closures, each free of offset and EMF; `None` without a drop.
///
/// `mean_u_v` is the standard uncertainty of their mean at the terminal. The budget omits the scatter from closure to
/// closure: the result is the mean of these closures.
pub fn resistance(drops: &[Volt], mohm_per_v: Factor, mean_u_v: f64) -> Option<Reading> {
    if drops.is_empty() {
        return None;
    }
    let n = drops.len() as f64;
    let value = mohm_per_v.value * drops.iter().map(|drop| drop.0).sum::<f64>() / n;
    let budget = Budget::default()
        .with_random("reading", mohm_per_v.value * mean_u_v)
        .with(
            "reference resistor",
            value * mohm_per_v.u / mohm_per_v.value,
        );
    Some(Reading {
        value,
        unit: Unit::Milliohm,
        budget,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reversal_removes_emf_and_offset() {
        let read = [0.9 + 0.0105, -0.9 + 0.0105].map(Volt);
        let closure = Closure::of(&read, Polarities::PlusMinus).expect("two readings");
        let reading =
            resistance(&[closure.drop], Factor::new(20.0, 0.005), 0.002).expect("one closure");
        assert!((reading.value - 18.0).abs() < 1e-12);
        assert!((closure.zero.0 - 0.0105).abs() < 1e-12);
    }

    #[test]
    fn only_four_readings_remove_linear_drift() {
        // 1 mV of drift per reading, and a longer pause at each reversal.
        let read = [(0.9, 0.0), (-0.9, 3.0), (-0.9, 4.0), (0.9, 7.0)];
        let read = read.map(|(drop, time)| Volt(drop + 0.001 * time));
        let four = Closure::of(&read, Polarities::PlusMinusMinusPlus).expect("four readings");
        assert!((four.drop.0 - 0.9).abs() < 1e-12);
        assert!((four.u_v(0.002) - 0.001).abs() < 1e-15);
        let two = Closure::of(&read[..2], Polarities::PlusMinus).expect("two readings");
        assert!((two.drop.0 - 0.8985).abs() < 1e-12);
        assert_eq!(Closure::of(&read, Polarities::PlusMinus), None);
    }

    #[test]
    fn a_shared_zero_is_not_averaged_away() {
        let half = |readings, later| u_with_later_v(readings, later, 1.0, 0.0).powi(2);
        for later in [0, 1, 3, 100] {
            assert!((half(2, later) - 0.5).abs() < 1e-12, "{later}");
        }
        assert!((half(4, 0) - 0.25).abs() < 1e-12);
        assert!((half(4, 1) - 0.375).abs() < 1e-12);
        let moved = u_with_later_v(2, 1, 0.0, 1.0);
        assert!(
            (moved - 0.5).abs() < 1e-12,
            "half of the mean is from the later one"
        );
    }

    #[test]
    fn no_closure_no_resistance() {
        assert!(resistance(&[], Factor::new(20.0, 0.005), 0.002).is_none());
    }
}
