//! Results that a plant measures outside of the rig, on samples of a lot: their keys, limits and judgement.
//!
//! Section `[external]` of a recipe names those that every lot needs, each with its limit. The rig never measures them,
//! so they are no [`Characteristic`](super::Characteristic) and no stage of a test.

use super::recipe::{Decision, Ends};
use crate::form::Range;
use crate::gauge::budget::{Budget, COVERAGE_FACTOR, Reading};
use crate::gauge::{Judgement, Limit, Rule, judge};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;
use texts::Lang;
use units::Unit;
use utoipa::ToSchema;

/// A quantity that is measured outside of the rig. Sorts in the order of reports.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, ToSchema,
)]
pub enum External {
    /// Greatest slope of the voltage at the blocked output that does not turn it on.
    #[serde(rename = "dv_dt_v_us")]
    StaticDvDt,
    /// Resistance between input and output.
    #[serde(rename = "r_iso_ohm")]
    IsolationResistance,
    /// Current between input and output at the voltage of the dielectric withstand test.
    #[serde(rename = "dwv_ua")]
    WithstandLeakage,
}

impl External {
    /// Every quantity, in the order of reports.
    pub const ALL: [Self; 3] = [
        Self::StaticDvDt,
        Self::IsolationResistance,
        Self::WithstandLeakage,
    ];

    /// Returns the key in recipes, files, rows and API, with the unit as suffix.
    pub const fn key(self) -> &'static str {
        match self {
            Self::StaticDvDt => "dv_dt_v_us",
            Self::IsolationResistance => "r_iso_ohm",
            Self::WithstandLeakage => "dwv_ua",
        }
    }

    /// Returns the quantity with this key.
    pub fn from_key(key: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|it| it.key() == key)
    }

    /// Returns the name on pages and paper.
    pub fn name(self, lang: Lang) -> &'static str {
        lang.text(&format!("external-{}", self.key()))
    }

    /// Returns the unit of values and limits.
    pub const fn unit(self) -> Unit {
        match self {
            Self::StaticDvDt => Unit::VoltPerMicrosecond,
            Self::IsolationResistance => Unit::Ohm,
            Self::WithstandLeakage => Unit::Microampere,
        }
    }

    /// Returns the range of values and limits.
    pub const fn range(self) -> Range {
        let (high, low_allowed) = match self {
            Self::StaticDvDt => (1e5, false),
            Self::IsolationResistance => (1e15, false),
            Self::WithstandLeakage => (1e5, true),
        };
        Range {
            unit: self.unit().symbol(),
            low: 0.0,
            high,
            low_allowed,
        }
    }
}

impl fmt::Display for External {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.key())
    }
}

/// Limits of `[external]`, in the unit of each key.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct ExternalLimits(BTreeMap<External, Ends>);

impl ExternalLimits {
    /// Returns true when the recipe demands no result from outside of the rig.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns the quantities that the recipe demands.
    pub fn demanded(&self) -> impl Iterator<Item = External> + '_ {
        self.0.keys().copied()
    }

    /// Returns the limit of a quantity; `None` when the recipe does not demand it.
    pub fn of(&self, external: External) -> Option<Limit> {
        let Ends { low, high } = *self.0.get(&external)?;
        let unit = external.unit();
        Some(Limit { unit, low, high })
    }
}

/// Judgement of a result from outside of the rig.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ExternalVerdict {
    /// The value keeps the limit; under `guard_band` by at least U.
    Pass,
    /// The value lies within U of the limit. The rig cannot measure it again, so the lot needs another result.
    Undecided,
    /// The value violates the limit; under `guard_band` by more than U.
    Fail,
}

impl ExternalVerdict {
    /// Returns the word in rows and JSON.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::Undecided => "undecided",
            Self::Fail => "fail",
        }
    }

    /// Returns the verdict with this word; an unknown word decides nothing.
    pub fn from_name(name: &str) -> Self {
        let mut all = [Self::Pass, Self::Fail].into_iter();
        all.find(|it| it.name() == name).unwrap_or(Self::Undecided)
    }
}

/// What a recipe demands of results from outside of the rig, read from the text that the history keeps.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
pub struct ExternalDemands {
    /// The limits.
    #[serde(default, rename = "external")]
    pub limits: ExternalLimits,
    decision: Option<Decision>,
}

impl ExternalDemands {
    /// Reads the text of a recipe that was checked when its lot began. A text that is no recipe, such as that of an
    /// imported lot, demands nothing.
    pub fn of_recipe(text: &str) -> Self {
        toml::from_str(text).unwrap_or_default()
    }

    /// Returns how the uncertainty enters the judgement.
    pub fn rule(&self) -> Rule {
        self.decision.map_or(Rule::GuardBand, |it| it.rule)
    }

    /// Judges a value with its expanded uncertainty (k = 2), both in the unit of `limit`.
    pub fn judge(&self, value: f64, expanded: Option<f64>, limit: &Limit) -> ExternalVerdict {
        let u = expanded.unwrap_or(0.0) / COVERAGE_FACTOR;
        let reading = Reading {
            value,
            unit: limit.unit,
            budget: Budget::default().with("stated", u),
        };
        match judge(&reading, limit, self.rule()) {
            Judgement::Pass => ExternalVerdict::Pass,
            Judgement::Fail(_) => ExternalVerdict::Fail,
            Judgement::Conditional(_) | Judgement::Void => ExternalVerdict::Undecided,
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn demands(rule: &str) -> ExternalDemands {
        let text = format!(
            "[external]\nr_iso_ohm = {{ low = 1e9 }}\ndwv_ua = {{ high = 10 }}\n\
             [decision]\nrule = \"{rule}\"\nslow_repeats = 3\n"
        );
        ExternalDemands::of_recipe(&text)
    }

    #[test]
    fn a_key_is_the_same_in_code_and_rows() {
        for external in External::ALL {
            let json = serde_json::to_string(&external).unwrap();
            assert_eq!(json, format!("\"{external}\""));
            assert_eq!(External::from_key(external.key()), Some(external));
        }
    }

    #[test]
    fn the_rule_of_the_recipe_judges() {
        use ExternalVerdict::{Fail, Pass, Undecided};
        for (rule, value, u, expected) in [
            ("guard_band", 10.0, Some(1.0), Undecided),
            ("guard_band", 9.0, Some(1.0), Pass),
            ("guard_band", 11.5, Some(1.0), Fail),
            ("simple", 10.0, Some(1.0), Pass),
            ("simple", 10.5, None, Fail),
            ("simple", f64::NAN, None, Undecided),
        ] {
            let demands = demands(rule);
            let limit = demands.limits.of(External::WithstandLeakage).unwrap();
            let found = demands.judge(value, u, &limit);
            assert_eq!(found, expected, "{rule} {value} {u:?}");
        }
    }

    #[test]
    fn only_a_recipe_with_the_section_demands_results() {
        let keys: Vec<External> = demands("simple").limits.demanded().collect();
        let expected = [External::IsolationResistance, External::WithstandLeakage];
        assert_eq!(keys, expected);
        for text in ["# imported", "no recipe", "name = \"a\""] {
            assert!(ExternalDemands::of_recipe(text).limits.is_empty());
        }
    }
}
