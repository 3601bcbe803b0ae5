//! Contact resistance, four-wire: drops with the 1 A source in both directions, whose difference is free of the thermal
//! EMF, of the converter's offset and of the monitor's current.
//!
//! A closure has one reading ([`ContactDrop::single`]) or, with the source reversed on it, several ([`Closure`]). Two closures
//! with one reading each in opposite directions have the mean resistance `R = K (V+ - V-) / 2`; any other number also
//! needs the drop without current, the [`Zero`]. The calibration finds `K` on the 50 mOhm reference with the same
//! source, amplifier and converter, so `K` contains the current and all gains.

use super::sampling::Polarities;
use crate::gauge::Factor;
use crate::gauge::budget::{Budget, Reading, rectangular};
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

/// Change of the thermal EMF between two closures (30 uV), volts at the terminal, behind the amplifier with gain 50.
const EMF_MOVES_V: f64 = 30e-6 * 50.0;
/// Largest drop of a closed contact without current, volts at the terminal: offsets, and the 11 mA of the contact monitor
/// across 100 mOhm.
const LARGEST_ZERO_V: f64 = 0.06;

/// Returns the standard uncertainty of one reading of a closure whose EMF lies as far from the mean as
/// [`EMF_MOVES_V`] between two closures permits.
fn on_one_closure(reading_v: f64) -> f64 {
    reading_v.hypot(EMF_MOVES_V / 2f64.sqrt())
}

/// Drop of a closed contact without current, volts at the terminal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Zero {
    volts: Volt,
    u_v: f64,
}

impl Zero {
    /// The zero before any reading.
    pub fn unknown() -> Self {
        Self {
            volts: Volt(0.0),
            u_v: rectangular(LARGEST_ZERO_V),
        }
    }

    /// Returns the zero read on one closure; `u_v` is the uncertainty of the reading.
    pub fn read(volts: Volt, u_v: f64) -> Self {
        Self {
            volts,
            u_v: on_one_closure(u_v),
        }
    }
}

/// Drop of one closure, turned to the forward direction, volts at the terminal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactDrop {
    turned: Volt,
    /// How often the zero enters `turned`: +1 forward, -1 reversed, 0 in a drop that is free of it.
    zeros: f64,
    u_v: f64,
}

impl ContactDrop {
    /// Returns the drop of a closure with one reading, forward or reversed; `reading_v` is the uncertainty of a reading.
    pub fn single(read: Volt, reverse: bool, reading_v: f64) -> Self {
        let sign = if reverse { -1.0 } else { 1.0 };
        Self {
            turned: read * sign,
            zeros: sign,
            u_v: on_one_closure(reading_v),
        }
    }

    /// Returns the drop of a closure read in both directions.
    pub fn reversed(closure: Closure, reading_v: f64) -> Self {
        Self {
            turned: closure.drop,
            zeros: 0.0,
            u_v: closure.u_v(reading_v),
        }
    }

    /// Returns the drop that the current causes.
    pub fn without(&self, zero: Zero) -> Volt {
        self.turned - zero.volts * self.zeros
    }
}

/// Returns the mean resistance of these closures in milliohms; `None` without a closure. The budget omits the scatter
/// from closure to closure: the result describes these closures.
pub fn resistance(drops: &[ContactDrop], zero: Zero, mohm_per_v: Factor) -> Option<Reading> {
    if drops.is_empty() {
        return None;
    }
    let n = drops.len() as f64;
    let mean_v = drops.iter().map(|it| it.without(zero).0).sum::<f64>() / n;
    let zeros = drops.iter().map(|it| it.zeros).sum::<f64>() / n;
    let own_2 = drops.iter().map(|it| it.u_v.powi(2)).sum::<f64>() / n.powi(2);
    let value = mohm_per_v.value * mean_v;
    let budget = Budget::default()
        .with_random(
            "reading",
            mohm_per_v.value * own_2.sqrt().hypot(zeros * zero.u_v),
        )
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

    const PER_V: Factor = Factor {
        value: 20.0,
        u: 0.005,
    };

    fn mohm(drops: &[ContactDrop], zero: Zero) -> Reading {
        resistance(drops, zero, PER_V).expect("a closure")
    }

    #[test]
    fn reversal_removes_emf_and_offset() {
        let read = [0.9 + 0.0105, -0.9 + 0.0105].map(Volt);
        let closure = Closure::of(&read, Polarities::PlusMinus).expect("two readings");
        let reading = mohm(&[ContactDrop::reversed(closure, 0.002)], Zero::unknown());
        assert!((reading.value - 18.0).abs() < 1e-12);
        assert!((closure.zero.0 - 0.0105).abs() < 1e-12);
    }

    #[test]
    fn two_closures_in_opposite_directions_need_no_zero() {
        let forward = ContactDrop::single(Volt(0.9 + 0.0105), false, 0.002);
        let reversed = ContactDrop::single(Volt(-1.1 + 0.0105), true, 0.002);
        let pair = mohm(&[forward, reversed], Zero::unknown());
        assert!((pair.value - 20.0).abs() < 1e-12, "mean of 18 and 22");
        assert!(pair.expanded() < 0.1);
        let alone = mohm(&[forward], Zero::unknown());
        assert!((alone.value - 18.0).abs() < alone.expanded(), "{alone:?}");
        assert!(alone.expanded() > 1.0);
        let zero = Zero::read(Volt(0.0105), 0.002);
        let third = mohm(&[forward, reversed, forward], zero);
        assert!((third.value - 58.0 / 3.0).abs() < 1e-12);
        assert!(third.expanded() < 0.1);
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
        let zero = Zero {
            volts: Volt(0.0),
            u_v: 1.0,
        };
        let drop = ContactDrop {
            turned: Volt(0.9),
            zeros: 1.0,
            u_v: 1.0,
        };
        let u_v = |closures| mohm(&vec![drop; closures], zero).budget.0[0].u / PER_V.value;
        assert!((u_v(1) - 2f64.sqrt()).abs() < 1e-12);
        assert!((u_v(100) - 1.01f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn no_closure_no_resistance() {
        assert!(resistance(&[], Zero::unknown(), PER_V).is_none());
    }
}
