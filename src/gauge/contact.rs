//! Contact resistance, four-wire, with the source reversed: `R = K (V+ - V-) / 2`.
//!
//! The reversal takes out the thermal EMF and the converter's offset; `K` was found on the 50 mOhm
//! reference with the same source, amplifier and converter, so it holds the current and all gains.

use super::budget::{Budget, Reading};
use super::calibration::Factor;
use crate::units::Volt;

/// One closure with both polarities of the source, volts at the terminal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reversal {
    /// Drop with the source forward.
    pub forward: Volt,
    /// Drop with the source reversed.
    pub reverse: Volt,
}

impl Reversal {
    /// What the drop reads without current: offset and thermal EMF.
    pub fn zero(&self) -> Volt {
        (self.forward + self.reverse) / 2.0
    }
    /// Drop of the current alone.
    pub fn drop(&self) -> Volt {
        (self.forward - self.reverse) / 2.0
    }
}

/// Resistance in milliohms from the drops of one or more closures, each free of offset and EMF.
///
/// `reading_v` is the standard uncertainty of one drop at the terminal. The scatter from closure to
/// closure is the part's own and is not in the budget: the mean of the closures read is the result.
pub fn resistance(drops: &[Volt], mohm_per_v: Factor, reading_v: f64) -> Option<Reading> {
    if drops.is_empty() {
        return None;
    }
    let n = drops.len() as f64;
    let value = mohm_per_v.value * drops.iter().map(|drop| drop.0).sum::<f64>() / n;
    let budget = Budget::default()
        .with_random("reading", mohm_per_v.value * reading_v / n.sqrt())
        .with(
            "reference resistor",
            value * mohm_per_v.u / mohm_per_v.value,
        );
    Some(Reading { value, budget })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reversal_removes_emf_and_offset() {
        let closure = Reversal {
            forward: Volt(0.9 + 0.0105),
            reverse: Volt(-0.9 + 0.0105),
        };
        let reading =
            resistance(&[closure.drop()], Factor::new(20.0, 0.005), 0.002).expect("one closure");
        assert!((reading.value - 18.0).abs() < 1e-12);
        assert!((closure.zero().0 - 0.0105).abs() < 1e-12);
    }

    #[test]
    fn no_closure_no_resistance() {
        assert!(resistance(&[], Factor::new(20.0, 0.005), 0.002).is_none());
    }
}
