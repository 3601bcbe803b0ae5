//! First contact of two grazing discs, in double-double precision.
//!
//! On a grazing pass, the fraction of the path at which contact begins depends on the square root of a small difference
//! of radii: a rounding of 1e-12 mm moves the contact by 1e-5 mm. Where the places of the bodies themselves are exact,
//! arithmetic with twice the digits decides whether the discs touch at all, and where.

/// A number as a sum of two f64, the second below the last place of the first (after Dekker and Knuth).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Twofold(f64, f64);

/// Relative error bound: a dozen operations with an error of 2^-104 each, and an ample reserve.
const ROUNDING: f64 = f64::EPSILON * f64::EPSILON * 1024.0;

impl Twofold {
    /// Converts a number that is exact in f64.
    pub(crate) fn of(exact: f64) -> Twofold {
        Twofold(exact, 0.0)
    }

    /// Returns `a + b`, exactly.
    pub(crate) fn sum(a: f64, b: f64) -> Twofold {
        let sum = a + b;
        let second = sum - a;
        Twofold(sum, (a - (sum - second)) + (b - second))
    }

    pub(crate) fn plus(self, other: Twofold) -> Twofold {
        let high = Twofold::sum(self.0, other.0);
        let low = Twofold::sum(self.1, other.1);
        let middle = Twofold::sum(high.0, high.1 + low.0);
        Twofold::sum(middle.0, middle.1 + low.1)
    }

    pub(crate) fn minus(self, other: Twofold) -> Twofold {
        self.plus(Twofold(-other.0, -other.1))
    }

    fn times(self, other: Twofold) -> Twofold {
        let product = self.0 * other.0;
        let lost = self.0.mul_add(other.0, -product);
        Twofold::sum(product, lost + (self.0 * other.1 + self.1 * other.0))
    }

    fn value(self) -> f64 {
        self.0 + self.1
    }
}

/// Returns the first fraction of the path `run`, rounded down, at which a point enters the disc of `radius` about the
/// origin; the point starts outside at `from`, and `run` is exact. `None` is proof that the point never enters.
pub(crate) fn first(from: [Twofold; 2], run: [f64; 2], radius: Twofold) -> Option<f64> {
    let [x, y] = from;
    let [u, v] = run.map(Twofold::of);
    let speed = u.times(u).plus(v.times(v));
    let nearing = Twofold::of(0.0).minus(x.times(u).plus(y.times(v)));
    let across = x.times(v).minus(y.times(u));
    let whole = radius.times(radius).times(speed);
    let left = whole.minus(across.times(across)).value();
    let error = ROUNDING * whole.value();
    if left < -error {
        return None;
    }
    let before = nearing.minus(Twofold::of(
        (left + error).sqrt() * (1.0 + 2.0 * f64::EPSILON),
    ));
    let t = before.value() / speed.value();
    Some(t - 4.0 * f64::EPSILON * t.abs())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn double_double_sums_keep_digits_that_f64_drops() {
        let large = Twofold::of(1e16).plus(Twofold::of(1.0));
        assert_eq!(large.minus(Twofold::of(1e16)).value(), 1.0);
        let near = Twofold::of(1.0).plus(Twofold::of(1e-20));
        let square = near.times(near).minus(Twofold::of(1.0));
        assert!((square.value() - 2e-20).abs() < 1e-31);
    }

    #[test]
    fn a_tangent_touches_midway_and_misses_slightly_farther_out() {
        let at = |y: f64| {
            let from = [Twofold::of(-4000.0), Twofold::of(y)];
            first(from, [8000.0, 0.0], Twofold::of(50.0))
        };
        let middle = at(50.0).unwrap();
        assert!(middle <= 0.5 && (0.5 - middle) * 8000.0 < 1e-9, "{middle}");
        assert_eq!(at(50.0f64.next_up()), None);
        assert!(at(50.0f64.next_down()).unwrap() < middle);
    }
}
