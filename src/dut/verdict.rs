//! Verdicts: a result against its limit with a guard band, a part from its results, a bin from both.
//!
//! Rule `guard_band` (ISO 14253-1, ILAC-G8 with w = U): pass when the value lies inside the limit by
//! at least U, fail when it lies outside by at least U, conditional in between. Rule `simple` judges
//! the bare value. A result that is not usable is void, never pass. Several failures go to the bin
//! of the first in the order coil, contact, voltage, time.

use super::em_relay::parameter::Parameter;
use super::recipe::{Limit, Rule};
use crate::dut::em_relay::bins;
use crate::gauge::budget::Reading;
pub use crate::rig::bin::Bin;
use serde::Serialize;
use std::fmt;

/// Side of a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Below the lower limit.
    Low,
    /// Above the upper limit.
    High,
}

impl fmt::Display for Side {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Side::Low => "low",
            Side::High => "high",
        })
    }
}

/// One result against its limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Judgement {
    /// Proven inside.
    Pass,
    /// Proven outside.
    Fail(Side),
    /// Within U of the limit: to be measured again by the slow strategy.
    Conditional(Side),
    /// No usable number.
    Void,
}

/// Holds one result against its limit; without a limit every usable result passes.
pub fn judge(reading: &Reading, limit: &Limit, rule: Rule) -> Judgement {
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

/// Bin of a part that fails `parameter`.
pub fn bin_of(parameter: Parameter) -> Bin {
    match parameter {
        Parameter::CoilResistance => bins::COIL,
        Parameter::OperateVoltage | Parameter::ReleaseVoltage => bins::VOLTAGE,
        Parameter::OperateTime
        | Parameter::ReleaseTime
        | Parameter::OperateBounce
        | Parameter::ReleaseBounce => bins::TIME,
        Parameter::ContactResistanceNo | Parameter::ContactResistanceNc => bins::CONTACT,
    }
}

/// Rank when several limits fail: the smallest wins.
fn rank(bin: Bin) -> usize {
    let known = bins::BY_RANK.into_iter().position(|known| known == bin);
    known.unwrap_or(bins::BY_RANK.len())
}

/// Why a part fails, and the bin this alone would send it to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reason {
    /// `operate_voltage_v high`, `coil open`.
    pub text: String,
    /// Bin of this cause.
    pub bin: Bin,
}

/// What is said of a part.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Verdict {
    /// Every limit proven.
    Pass,
    /// At least one reason, worst first.
    Fail(Vec<Reason>),
    /// Not judged, with the reasons.
    Void(Vec<String>),
}

impl Verdict {
    /// `pass`, `fail` or `void`.
    pub fn name(&self) -> &'static str {
        match self {
            Verdict::Pass => "pass",
            Verdict::Fail(_) => "fail",
            Verdict::Void(_) => "void",
        }
    }

    /// Where the part belongs.
    pub fn bin(&self) -> Bin {
        match self {
            Verdict::Pass => Bin::PASS,
            Verdict::Fail(reasons) => reasons
                .iter()
                .map(|reason| reason.bin)
                .min_by_key(|bin| rank(*bin))
                .unwrap_or(Bin::RETEST),
            Verdict::Void(_) => Bin::RETEST,
        }
    }

    /// Reasons as text; none for a pass.
    pub fn reasons(&self) -> Vec<String> {
        match self {
            Verdict::Pass => Vec::new(),
            Verdict::Fail(reasons) => reasons.iter().map(|reason| reason.text.clone()).collect(),
            Verdict::Void(reasons) => reasons.clone(),
        }
    }
}

/// A failure found outside the limits together with those against limits, worst bin first.
pub fn failed_with(reason: &Reason, others: Vec<Reason>) -> Verdict {
    let mut reasons = others;
    reasons.push(reason.clone());
    reasons.sort_by_key(|reason| rank(reason.bin));
    Verdict::Fail(reasons)
}

/// Verdict of a part whose nine results were judged; conditional results have had their second chance.
///
/// A proven failure outweighs a void: the part is bad whatever else could not be seen.
pub fn of_part(judged: &[(Parameter, Judgement)]) -> Verdict {
    let mut reasons: Vec<Reason> = judged
        .iter()
        .filter_map(|(parameter, judgement)| {
            let text = match judgement {
                Judgement::Fail(side) => format!("{} {side}", parameter.name()),
                Judgement::Conditional(side) => format!("{} {side} not proven", parameter.name()),
                Judgement::Pass | Judgement::Void => return None,
            };
            Some(Reason {
                text,
                bin: bin_of(*parameter),
            })
        })
        .collect();
    if !reasons.is_empty() {
        reasons.sort_by_key(|reason| rank(reason.bin));
        return Verdict::Fail(reasons);
    }
    let void: Vec<String> = Parameter::ALL
        .iter()
        .filter(|parameter| {
            !judged
                .iter()
                .any(|(known, judgement)| known == *parameter && *judgement == Judgement::Pass)
        })
        .map(|parameter| format!("{} not measured", parameter.name()))
        .collect();
    if void.is_empty() {
        Verdict::Pass
    } else {
        Verdict::Void(void)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gauge::budget::Budget;

    fn reading(value: f64, u: f64) -> Reading {
        Reading {
            value,
            budget: Budget::default().with("test", u),
        }
    }

    fn high(high: f64) -> Limit {
        Limit {
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
    fn what_is_not_a_number_is_void_and_never_passes() {
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

    #[test]
    fn a_part_passes_only_when_all_nine_results_pass() {
        let all: Vec<_> = Parameter::ALL
            .iter()
            .map(|p| (*p, Judgement::Pass))
            .collect();
        assert_eq!(of_part(&all), Verdict::Pass);
        assert_eq!(of_part(&all[1..]).bin(), Bin::RETEST);
    }

    #[test]
    fn several_failures_go_to_coil_then_contact_then_voltage_then_time() {
        let failed = [
            (Parameter::OperateTime, Judgement::Fail(Side::High)),
            (Parameter::OperateVoltage, Judgement::Fail(Side::High)),
            (Parameter::ContactResistanceNo, Judgement::Fail(Side::High)),
        ];
        assert_eq!(of_part(&failed).bin(), bins::CONTACT);
        assert_eq!(of_part(&failed[..2]).bin(), bins::VOLTAGE);
    }
}
