//! Judges one result against its limit, with a guard band.
//!
//! Rule `guard_band` (ISO 14253-1, ILAC-G8 with w = U): pass when the value lies inside the limit by at least U, fail
//! when it lies outside by more than U, conditional in between. Rule `simple` compares the value alone. A result
//! without a usable number is void and never passes.

use super::budget::Reading;
use serde::{Deserialize, Serialize};
use std::fmt;
use units::Unit;
use utoipa::ToSchema;

/// Limits of one characteristic, inclusive; `None` leaves a side open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit {
    /// Unit of both sides.
    pub unit: Unit,
    /// Least acceptable value.
    pub low: Option<f64>,
    /// Greatest acceptable value.
    pub high: Option<f64>,
}

impl Limit {
    /// Returns true when both sides are open.
    pub fn is_open(&self) -> bool {
        self.low.is_none() && self.high.is_none()
    }
}

/// How a judgement takes the uncertainty into account.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Rule {
    /// Moves the limit inwards by the expanded uncertainty (k = 2).
    GuardBand,
    /// Compares the value alone.
    Simple,
}

/// Side of a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Below the lower limit.
    Low,
    /// Above the upper limit.
    High,
}

impl Side {
    /// Returns `low` or `high`, as in rows.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Low => "low",
            Self::High => "high",
        }
    }

    /// Returns the side with this name.
    pub fn from_name(name: &str) -> Option<Self> {
        [Self::Low, Self::High]
            .into_iter()
            .find(|it| it.name() == name)
    }
}

impl fmt::Display for Side {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Judgement of one result against its limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Judgement {
    /// Inside the limit; under `guard_band` by at least U.
    Pass,
    /// Outside the limit; under `guard_band` by more than U.
    Fail(Side),
    /// Within U of the limit, on the side given: confirmation measurements must decide.
    Conditional(Side),
    /// No usable number.
    Void,
}

impl Judgement {
    /// Returns the verdict that the row of one attempt states; an attempt within U of a limit has not passed.
    pub const fn verdict(self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::Fail(_) | Self::Conditional(_) => "fail",
            Self::Void => "void",
        }
    }
}

/// Judges one result against its limit; an open limit passes every usable result.
///
/// # Panics
/// Panics when reading and limit have different units.
pub fn judge(reading: &Reading, limit: &Limit, rule: Rule) -> Judgement {
    assert_eq!(
        reading.unit, limit.unit,
        "reading and limit have different units"
    );
    if !reading.is_usable() {
        return Judgement::Void;
    }
    let band = match rule {
        Rule::GuardBand => reading.expanded(),
        Rule::Simple => 0.0,
    };
    let inside_low = limit.low.map_or(f64::INFINITY, |low| reading.value - low);
    let inside_high = limit
        .high
        .map_or(f64::INFINITY, |high| high - reading.value);
    let (inside, side) = if inside_low < inside_high {
        (inside_low, Side::Low)
    } else {
        (inside_high, Side::High)
    };
    if inside >= band {
        Judgement::Pass
    } else if inside < -band || band == 0.0 {
        Judgement::Fail(side)
    } else {
        Judgement::Conditional(side)
    }
}

#[cfg(test)]
mod tests {
    use super::super::budget::Budget;
    use super::*;

    fn reading(value: f64, u: f64) -> Reading {
        Reading {
            value,
            unit: Unit::Ohm,
            budget: Budget::default().with("test", u),
        }
    }

    fn high(high: f64) -> Limit {
        Limit {
            unit: Unit::Ohm,
            low: None,
            high: Some(high),
        }
    }

    #[test]
    fn a_guard_band_moves_the_limit_inwards_by_u() {
        let rule = Rule::GuardBand;
        assert_eq!(
            judge(&reading(8.97, 0.01), &high(9.0), rule),
            Judgement::Pass
        );
        assert_eq!(
            judge(&reading(8.99, 0.01), &high(9.0), rule),
            Judgement::Conditional(Side::High)
        );
        assert_eq!(
            judge(&reading(9.01, 0.01), &high(9.0), rule),
            Judgement::Conditional(Side::High)
        );
        assert_eq!(
            judge(&reading(9.03, 0.01), &high(9.0), rule),
            Judgement::Fail(Side::High)
        );
    }

    #[test]
    fn the_simple_rule_judges_the_bare_value() {
        let rule = Rule::Simple;
        assert_eq!(judge(&reading(9.0, 0.5), &high(9.0), rule), Judgement::Pass);
        assert_eq!(
            judge(&reading(9.0001, 0.5), &high(9.0), rule),
            Judgement::Fail(Side::High)
        );
    }

    #[test]
    #[should_panic(expected = "reading and limit have different units")]
    fn a_result_is_never_judged_in_another_unit() {
        let limit = Limit {
            unit: Unit::Milliohm,
            ..high(9.0)
        };
        judge(&reading(1.0, 0.01), &limit, Rule::Simple);
    }

    #[test]
    fn nan_is_void_and_never_passes() {
        let rule = Rule::GuardBand;
        assert_eq!(
            judge(&reading(f64::NAN, 0.01), &high(9.0), rule),
            Judgement::Void
        );
        assert_eq!(
            judge(&reading(1.0, f64::NAN), &high(9.0), rule),
            Judgement::Void
        );
    }
}
