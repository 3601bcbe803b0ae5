//! One figure of a study, and its bar: the acceptance limit of its value.

use quality::Spread;
use serde_json::{Value, json};

/// Acceptance limit of a figure: a range that includes its ends, except for [`Bar::Below`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bar {
    /// At most.
    AtMost(f64),
    /// Less than.
    Below(f64),
    /// At least.
    AtLeast(f64),
    /// From low to high.
    Within(f64, f64),
}

impl Bar {
    /// Returns whether a value meets the bar; NaN never does.
    pub fn is_met(self, value: f64) -> bool {
        match self {
            Self::AtMost(high) => value <= high,
            Self::Below(high) => value < high,
            Self::AtLeast(low) => value >= low,
            Self::Within(low, high) => (low..=high).contains(&value),
        }
    }

    /// Returns the text of the report column `bar`.
    pub fn text(self) -> String {
        match self {
            Self::AtMost(high) => format!("<= {high}"),
            Self::Below(high) => format!("< {high}"),
            Self::AtLeast(low) => format!(">= {low}"),
            Self::Within(low, high) => format!("{low} to {high}"),
        }
    }

    /// Parses a text of [`Bar::text`]; `None` for any other text.
    pub fn read(text: &str) -> Option<Self> {
        let number = |text: &str| text.trim().parse::<f64>().ok();
        if let Some(high) = text.strip_prefix("<=") {
            number(high).map(Self::AtMost)
        } else if let Some(high) = text.strip_prefix('<') {
            number(high).map(Self::Below)
        } else if let Some(low) = text.strip_prefix(">=") {
            number(low).map(Self::AtLeast)
        } else {
            let (low, high) = text.split_once(" to ")?;
            Some(Self::Within(number(low)?, number(high)?))
        }
    }
}

/// One row of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Name, the first column of the report.
    pub name: String,
    /// Number of parts, lots or runs behind the value.
    pub n: u64,
    /// The value to which the bar applies; `None` when nothing was measured.
    pub value: Option<f64>,
    /// Unit of `value` and of `more`, unless a column names its own.
    pub unit: &'static str,
    /// Further columns, key and number each; the bar does not apply to them.
    pub more: Vec<(&'static str, Option<f64>)>,
    /// Bar of the value; `None` for a figure that is only information.
    pub bar: Option<Bar>,
}

impl Figure {
    /// Creates a figure without a bar; a value that is not finite becomes `None`.
    pub fn new(name: impl Into<String>, n: u64, value: Option<f64>, unit: &'static str) -> Self {
        let value = value.filter(|it| it.is_finite());
        Self {
            name: name.into(),
            n,
            value,
            unit,
            more: Vec::new(),
            bar: None,
        }
    }

    /// Creates the figure of a count out of `n`, without a bar.
    pub fn count(name: impl Into<String>, n: u64, count: Option<u64>) -> Self {
        Self::new(name, n, count.map(|it| it as f64), "")
    }

    /// Creates the figure of a count of events that must not happen; its bar is zero.
    pub fn none(name: impl Into<String>, n: u64, count: u64) -> Self {
        Self::count(name, n, Some(count)).bar(Bar::AtMost(0.0))
    }

    /// Returns the same figure with a bar.
    pub fn bar(self, bar: Bar) -> Self {
        Self {
            bar: Some(bar),
            ..self
        }
    }

    /// Returns the same figure with one more column.
    pub fn with(mut self, key: &'static str, value: Option<f64>) -> Self {
        self.more.push((key, value.filter(|it| it.is_finite())));
        self
    }

    /// Returns whether the value meets the bar: `None` without a bar, false without a value.
    pub fn met(&self) -> Option<bool> {
        self.bar
            .map(|bar| self.value.is_some_and(|value| bar.is_met(value)))
    }

    /// Returns the figure as one JSON object of type `figure`.
    pub fn json(&self, study: &str) -> Value {
        let mut it = json!({
            "type": "figure", "study": study, "figure": self.name, "n": self.n, "value": self.value, "unit": self.unit,
        });
        for (key, value) in &self.more {
            it[*key] = json!(value);
        }
        it["bar"] = json!(self.bar.map(Bar::text));
        it["met"] = json!(self.met());
        it
    }
}

/// Returns `some` as a share of `all`, percent; `None` when `all` is 0.
pub fn percent(some: u64, all: u64) -> Option<f64> {
    (all > 0).then(|| 100.0 * some as f64 / all as f64)
}

/// Returns `some` as a share of `all`, percent; `None` unless both are known and `all` is above 0.
pub fn share_pct(some: Option<f64>, all: Option<f64>) -> Option<f64> {
    Some(100.0 * some? / all.filter(|all| *all > 0.0)?)
}

/// Returns the mean; `None` without values.
pub fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    Spread::of(&values.collect::<Vec<f64>>()).mean()
}

/// Returns the root of the mean square; `None` without values.
pub fn rms(values: impl Iterator<Item = f64>) -> Option<f64> {
    mean(values.map(|it| it * it)).map(f64::sqrt)
}

/// Formats a value without an exponent: to five significant digits, but with the whole integer part, at most six
/// decimals, and no decimals for whole numbers below 1e9. Returns "-" for NaN and infinity.
pub fn shown(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return if value == 0.0 { "0".into() } else { "-".into() };
    }
    if value.fract() == 0.0 && value.abs() < 1e9 {
        return format!("{value:.0}");
    }
    let before_point = value.abs().log10().floor() as i32 + 1;
    let decimals = usize::try_from((5 - before_point).clamp(0, 6)).unwrap_or(0);
    format!("{value:.decimals$}")
}
