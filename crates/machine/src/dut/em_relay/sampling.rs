//! Number of readings per result: scans of the coil, polarities and closures of a contact. The recipe sets them next
//! to the strategies of the thresholds.
//!
//! Polarities of closures: `alternating` reads each closure once, the first two of a contact in opposite directions.
//! `plus_minus` reads each NO closure and the NC closure at rest in both. Either cancels what is constant (offset,
//! thermal EMF); `plus_minus_minus_plus` also cancels linear drift, and halves the variance of the reading.
//!
//! Closures of one part scatter by their contact films, far more than readings do. With `stops_early` a part gets
//! another closure only while `|mean - limit| <= 3 sqrt(u^2 + s^2 / n)`: u is the uncertainty that all closures share,
//! s their scatter, at least that which the recipe expects of a film.

use crate::gauge::Limit;
use serde::{Deserialize, Serialize};
use units::Unit;

/// Distance of a mean from its limit beyond which the test adds no closure, in standard deviations. With it, 0.13 % of
/// the parts that lie at the limit are judged wrongly.
const CLEAR: f64 = 3.0;

/// Directions of the source.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Polarities {
    /// One direction per closure. NC: reversed at rest, forward after the timed release. NO: forward after the timed
    /// operation, reversed on the closure of the coarse ramps.
    #[default]
    Alternating,
    /// Forward, reversed on one closure.
    PlusMinus,
    /// Forward, reversed, reversed, forward on one closure.
    PlusMinusMinusPlus,
}

impl Polarities {
    /// Names in recipes.
    pub const NAMES: [&'static str; 3] = ["alternating", "plus_minus", "plus_minus_minus_plus"];

    /// Returns the signs of the source on one closure in the order of the readings.
    pub fn signs(self) -> &'static [f64] {
        match self {
            Self::Alternating => &[1.0],
            Self::PlusMinus => &[1.0, -1.0],
            Self::PlusMinusMinusPlus => &[1.0, -1.0, -1.0, 1.0],
        }
    }
}

/// Sampling of the contacts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct ContactSampling {
    /// Directions in which the closures are read.
    pub polarities: Polarities,
    /// Greatest number of timed closures of either contact; NC has the closure at rest in addition.
    pub closures: u32,
    /// True to stop repeating closures once both means are clear of their limits.
    pub stops_early: bool,
    /// Smallest expected scatter of a film from closure to closure, percent of the resistance (1 sd).
    pub closure_scatter_pct: u32,
}

impl Default for ContactSampling {
    fn default() -> Self {
        Self {
            polarities: Polarities::Alternating,
            closures: 1,
            stops_early: false,
            closure_scatter_pct: 10,
        }
    }
}

impl ContactSampling {
    /// Returns true when more closures would not change the judgement of this contact: `values_mohm` holds the
    /// closures so far, `u_mohm` the standard uncertainty that they share.
    pub fn is_clear(&self, values_mohm: &[f64], u_mohm: f64, limit: &Limit) -> bool {
        assert_eq!(limit.unit, Unit::Milliohm, "the limit of something else");
        let n = values_mohm.len() as f64;
        let mean = values_mohm.iter().sum::<f64>() / n;
        let squares: f64 = values_mohm.iter().map(|it| (it - mean).powi(2)).sum();
        let seen = (squares / (n - 1.0).max(1.0)).sqrt();
        let expected = mean.abs() * f64::from(self.closure_scatter_pct) / 100.0;
        let band = CLEAR * u_mohm.hypot(seen.max(expected) / n.sqrt());
        let away = |end: Option<f64>| end.is_none_or(|end| (mean - end).abs() > band);
        !values_mohm.is_empty() && away(limit.low) && away(limit.high)
    }
}

/// Sampling of the coil.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct CoilSampling {
    /// Time from switching the drive on until a conversion may begin, ms.
    pub settles_ms: u32,
    /// Number of scans that are averaged.
    pub scans: u32,
}

impl Default for CoilSampling {
    /// The default wait is 32 ms. The current settles to 0.05 % within 13 ms (7.6 L/R of an open armature), but the
    /// pre-bias lifts the armature from its stop, and the swing moves the current by up to 0.4 % until it dies out.
    fn default() -> Self {
        Self {
            settles_ms: 32,
            scans: 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMIT: Limit = Limit {
        unit: Unit::Milliohm,
        low: None,
        high: Some(100.0),
    };

    fn sampling(closure_scatter_pct: u32) -> ContactSampling {
        ContactSampling {
            closure_scatter_pct,
            ..ContactSampling::default()
        }
    }

    #[test]
    fn only_closures_near_the_limit_repeat() {
        let films_of_10 = sampling(10);
        assert!(films_of_10.is_clear(&[18.0], 0.05, &LIMIT));
        // 3 x 10 % of 80 is 24 mOhm: the true mean may exceed 100.
        assert!(!films_of_10.is_clear(&[80.0], 0.05, &LIMIT));
        assert!(films_of_10.is_clear(&[150.0], 0.05, &LIMIT));
    }

    #[test]
    fn agreeing_closures_narrow_the_band() {
        let films_of_10 = sampling(10);
        assert!(!films_of_10.is_clear(&[86.0; 3], 0.05, &LIMIT), "3 x 5.0");
        assert!(films_of_10.is_clear(&[86.0; 4], 0.05, &LIMIT), "3 x 4.3");
    }

    #[test]
    fn disagreeing_closures_widen_the_expected_scatter() {
        assert!(sampling(1).is_clear(&[50.0, 51.0], 0.05, &LIMIT));
        assert!(!sampling(1).is_clear(&[20.0, 80.0], 0.05, &LIMIT));
    }

    #[test]
    fn closures_do_not_average_their_shared_uncertainty() {
        assert!(!sampling(0).is_clear(&[95.0; 20], 2.0, &LIMIT));
        assert!(sampling(0).is_clear(&[95.0; 20], 1.0, &LIMIT));
    }

    #[test]
    fn no_closure_is_unclear_and_no_limit_is_clear() {
        assert!(!sampling(10).is_clear(&[], 0.0, &LIMIT));
        assert!(!sampling(10).is_clear(&[f64::NAN], 0.0, &LIMIT));
        let open = Limit {
            high: None,
            ..LIMIT
        };
        assert!(sampling(10).is_clear(&[99.0], 0.0, &open));
    }

    #[test]
    fn polarity_signs_cancel_offset_and_drift() {
        for polarities in [Polarities::PlusMinus, Polarities::PlusMinusMinusPlus] {
            assert_eq!(polarities.signs().iter().sum::<f64>(), 0.0);
        }
        let four = Polarities::PlusMinusMinusPlus.signs();
        let drift: f64 = four
            .iter()
            .zip([0.0, 30.0, 44.0, 74.0])
            .map(|(s, t)| s * t)
            .sum();
        assert_eq!(drift, 0.0);
    }
}
