//! Double-double arithmetic: sums and products in twice the digits of `f64`, as an unevaluated pair `high + low`.
//!
//! Only what the statistics need: addition and multiplication of two `f64` without error, and the operations on pairs
//! that are built from them. The precision is about 31 decimal digits.

/// The number `high + low`, with `low` at most half a unit in the last place of `high`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Double {
    high: f64,
    low: f64,
}

/// Returns the sum together with its exact rounding error (the two-sum algorithm, for any magnitudes).
fn two_sum(a: f64, b: f64) -> Double {
    let high = a + b;
    let b_seen = high - a;
    Double {
        high,
        low: (a - (high - b_seen)) + (b - b_seen),
    }
}

/// Returns the same as [`two_sum`] with fewer operations; only for `|a| >= |b|`.
fn quick(a: f64, b: f64) -> Double {
    let high = a + b;
    Double {
        high,
        low: b - (high - a),
    }
}

impl Double {
    pub fn new(value: f64) -> Self {
        Self {
            high: value,
            low: 0.0,
        }
    }
    pub fn value(self) -> f64 {
        self.high + self.low
    }
    pub fn plus(self, other: Self) -> Self {
        let high = two_sum(self.high, other.high);
        let low = two_sum(self.low, other.low);
        let carried = quick(high.high, high.low + low.high);
        quick(carried.high, carried.low + low.low)
    }
    pub fn minus(self, other: Self) -> Self {
        self.plus(Self {
            high: -other.high,
            low: -other.low,
        })
    }
    pub fn times(self, other: Self) -> Self {
        let high = self.high * other.high;
        let error = self.high.mul_add(other.high, -high);
        quick(
            high,
            error + (self.high * other.low + self.low * other.high),
        )
    }
    /// Divides by an `f64`, with two corrections of the quotient.
    pub fn over(self, divisor: f64) -> Self {
        let by = Self::new(divisor);
        let first = self.high / divisor;
        let rest = self.minus(Self::new(first).times(by));
        let second = rest.high / divisor;
        let rest = rest.minus(Self::new(second).times(by));
        quick(first, second).plus(Self::new(rest.high / divisor))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_third_three_times_is_one_to_thirty_digits() {
        let third = Double::new(1.0).over(3.0);
        let rest = third
            .times(Double::new(3.0))
            .minus(Double::new(1.0))
            .value();
        assert!(rest.abs() < 1e-31, "{rest:e}");
    }

    #[test]
    fn a_small_term_survives_a_large_sum() {
        let sum = Double::new(1e16)
            .plus(Double::new(0.125))
            .minus(Double::new(1e16));
        assert_eq!(sum.value(), 0.125);
    }
}
