//! A part with its measurements as page, exports and `--json` show it.

use super::{Moment, curve};
use machine::dut::Reason;
use machine::instrument::curve::Curve;
use serde::Serialize;

/// A part with its results.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Part {
    /// Always `part`, as in the output of a run.
    #[serde(rename = "type")]
    pub tag: &'static str,
    /// Name of the lot.
    pub lot: String,
    /// Number of the run within its lot.
    pub run: u32,
    /// `lot` or `golden`.
    pub kind: String,
    /// Count of parts that entered the nest.
    pub seq: u64,
    /// Name of the recipe.
    pub recipe: String,
    /// Serial number.
    pub serial: Option<String>,
    /// `pass`, `fail`, `void` or `unjudged`.
    pub verdict: String,
    /// Bin of the verdict.
    pub bin: Option<String>,
    /// Bin whose beam confirmed the part.
    pub landed_bin: Option<String>,
    /// Time of that confirmation.
    pub landed_at: Option<Moment>,
    /// Reasons against a pass, as texts.
    pub reasons: Vec<String>,
    /// The same reasons as codes.
    pub reason_codes: Vec<Reason>,
    /// Time of the verdict.
    pub time: Moment,
    /// Time from probes up to verdict, rig seconds.
    pub test_s: Option<f64>,
    /// Time since the previous nest exit, rig seconds.
    pub cycle_s: Option<f64>,
    /// Last value of each parameter, by key.
    pub values: serde_json::Map<String, serde_json::Value>,
    /// Expanded uncertainty (k = 2) of each value, by key.
    pub uncertainty: serde_json::Map<String, serde_json::Value>,
    /// All attempts with their samples; filled for a single part only.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub measurements: Vec<Measurement>,
    /// Sampled curves of a part that did not pass; filled for a single part only.
    #[serde(skip_serializing_if = "Vec::is_empty", serialize_with = "curve::shown")]
    pub curves: Vec<Curve>,
    #[serde(skip)]
    pub(super) row: i64,
}

/// One attempt to measure one parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Measurement {
    /// Parameter key.
    pub parameter: String,
    /// Number of the attempt, from 1.
    pub attempt: u32,
    /// Value in the unit of the key.
    pub value: Option<f64>,
    /// Expanded uncertainty, k = 2.
    pub uncertainty: Option<f64>,
    /// Lower limit in force.
    pub low: Option<f64>,
    /// Upper limit in force.
    pub high: Option<f64>,
    /// Verdict of this attempt.
    pub verdict: String,
    /// Uncertainty budget.
    pub budget: Option<serde_json::Value>,
    /// Replies that the value was computed from.
    pub samples: Vec<Sample>,
}

/// One reply of a module.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Sample {
    /// Serial line.
    pub line: String,
    /// Module address.
    pub module: String,
    /// Channel of the module.
    pub channel: String,
    /// Text sent.
    pub command: String,
    /// Text received.
    pub raw: String,
    /// Time of the last byte.
    pub at: Moment,
}

#[cfg(any(test, feature = "fixture"))]
impl Part {
    /// Returns the part with these reasons.
    pub fn with_reasons(mut self, reasons: Vec<Reason>) -> Self {
        self.reasons = reasons.iter().map(Reason::to_string).collect();
        self.reason_codes = reasons;
        self
    }

    /// Returns a part of run 1 without measurements.
    pub fn fixture(lot: &str, seq: u64, verdict: &str) -> Self {
        Self {
            tag: "part",
            lot: lot.to_owned(),
            run: 1,
            kind: "lot".to_owned(),
            seq,
            recipe: "jzc-22f-012".to_owned(),
            serial: None,
            verdict: verdict.to_owned(),
            bin: Some(verdict.to_owned()),
            landed_bin: None,
            landed_at: None,
            reasons: Vec::new(),
            reason_codes: Vec::new(),
            time: Moment(1_000_000),
            test_s: None,
            cycle_s: None,
            values: serde_json::Map::new(),
            uncertainty: serde_json::Map::new(),
            measurements: Vec::new(),
            curves: Vec::new(),
            row: 0,
        }
    }
}
