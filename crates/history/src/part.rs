//! A part with what was measured on it, as it leaves the history: what screens, sheets and `--json` show.

use super::{Moment, curve};
use machine::dut::Reason;
use machine::instrument::curve::Curve;
use serde::Serialize;

/// A part as screens, sheets and `--json` show it.
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
    /// The bin the verdict asks for.
    pub bin: Option<String>,
    /// The bin whose beam saw it.
    pub landed_bin: Option<String>,
    /// When the beam saw it.
    pub landed_at: Option<Moment>,
    /// Why it is not a pass.
    pub reasons: Vec<String>,
    /// The codes of the reasons, in their order.
    pub reason_codes: Vec<Reason>,
    /// When the verdict stood.
    pub time: Moment,
    /// Probes up to verdict, rig seconds.
    pub test_s: Option<f64>,
    /// Since the previous nest exit, rig seconds.
    pub cycle_s: Option<f64>,
    /// Last value of each parameter, by key.
    pub values: serde_json::Map<String, serde_json::Value>,
    /// Its expanded uncertainty, k = 2.
    pub uncertainty: serde_json::Map<String, serde_json::Value>,
    /// Every attempt, with its samples; only on a single part.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub measurements: Vec<Measurement>,
    /// What was seen of it, when it did not pass; only on a single part.
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
    /// 1, or more when measured again.
    pub attempt: u32,
    /// In the unit of the key.
    pub value: Option<f64>,
    /// Expanded, k = 2.
    pub uncertainty: Option<f64>,
    /// Lower limit in force.
    pub low: Option<f64>,
    /// Upper limit in force.
    pub high: Option<f64>,
    /// Verdict of this attempt alone.
    pub verdict: String,
    /// Uncertainty budget.
    pub budget: Option<serde_json::Value>,
    /// The replies it was made of.
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
    /// When the reply was complete.
    pub at: Moment,
}

#[cfg(any(test, feature = "fixture"))]
impl Part {
    /// The same part, failed for these reasons.
    pub fn with_reasons(mut self, reasons: Vec<Reason>) -> Self {
        self.reasons = reasons.iter().map(Reason::to_string).collect();
        self.reason_codes = reasons;
        self
    }

    /// A part of run 1 with nothing measured.
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
