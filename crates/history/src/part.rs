//! A part with its measurements, as page, exports and `--json` show it.

use super::{ExternalResult, Moment, curve};
use machine::dut::Reason;
use machine::instrument::curve::Curve;
use serde::Serialize;
use utoipa::ToSchema;

/// A part with its results.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Part {
    /// Always `part`, as in the output of a run.
    #[serde(rename = "type")]
    pub tag: &'static str,
    /// Name of the lot.
    pub lot: String,
    /// Number of the run within its lot.
    pub run: u32,
    /// Plant and name of the rig, where the answer may be of several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rig: Option<String>,
    /// `lot` for a production part, `golden` for a reference part.
    pub kind: String,
    /// Number of the part: it was the `seq`-th of its kind to enter the nest in this run.
    pub seq: u64,
    /// Name of the recipe.
    pub recipe: String,
    /// Serial number, if the part has one.
    pub serial: Option<String>,
    /// `pass`, `fail`, `void` or `unjudged`.
    pub verdict: String,
    /// Bin that the verdict assigns, if any.
    pub bin: Option<String>,
    /// Bin whose beam saw the part fall; `None` until then.
    pub landed_bin: Option<String>,
    /// Time at which the beam of `landed_bin` saw the part.
    pub landed_at: Option<Moment>,
    /// Reasons why the part did not pass, as texts.
    pub reasons: Vec<String>,
    /// Reasons why the part did not pass, as codes.
    pub reason_codes: Vec<Reason>,
    /// Time of the verdict.
    pub time: Moment,
    /// Time from the raising of the probes to the verdict, seconds of rig time (simulated time on a simulated rig).
    pub test_s: Option<f64>,
    /// Time since the previous part left the nest, seconds of rig time.
    pub cycle_s: Option<f64>,
    /// Value of the last attempt at each parameter, by key.
    pub values: serde_json::Map<String, serde_json::Value>,
    /// Expanded uncertainty (k = 2) of each value, by key.
    pub uncertainty: serde_json::Map<String, serde_json::Value>,
    /// All attempts with their samples; filled only when a single part is read.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub measurements: Vec<Measurement>,
    /// Sampled curves of a part that did not pass; filled only when a single part is read.
    #[serde(skip_serializing_if = "Vec::is_empty", serialize_with = "curve::shown")]
    #[schema(value_type = Vec<curve::Shown>)]
    pub curves: Vec<Curve>,
    /// Results on this part from outside of the rig, in order of entry.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub external: Vec<ExternalResult>,
    #[serde(skip)]
    pub(super) row: i64,
}

/// One attempt at measuring one parameter.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Measurement {
    /// Key of the parameter.
    pub parameter: String,
    /// Number of the attempt, from 1.
    pub attempt: u32,
    /// Value, in the unit that the key names; `None` without a usable value.
    pub value: Option<f64>,
    /// Expanded uncertainty (k = 2), in the unit of `value`.
    pub uncertainty: Option<f64>,
    /// Lower limit of the recipe, if any.
    pub low: Option<f64>,
    /// Upper limit of the recipe, if any.
    pub high: Option<f64>,
    /// Verdict of this attempt.
    pub verdict: String,
    /// Uncertainty budget, as JSON.
    pub budget: Option<serde_json::Value>,
    /// Replies from which the value was computed.
    pub samples: Vec<Sample>,
}

/// One reply of a module.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
pub struct Sample {
    /// Name of the serial line.
    pub line: String,
    /// Address of the module.
    pub module: String,
    /// Channel of the module; empty for a reply about the whole module.
    pub channel: String,
    /// Request as sent.
    pub command: String,
    /// Reply as received.
    pub raw: String,
    /// Time at which the last byte of the reply arrived.
    pub at: Moment,
}

#[cfg(any(test, feature = "fixture"))]
impl Part {
    /// Returns the part with these reasons, as codes and as texts.
    pub fn with_reasons(mut self, reasons: Vec<Reason>) -> Self {
        self.reasons = reasons.iter().map(Reason::to_string).collect();
        self.reason_codes = reasons;
        self
    }

    /// Returns a part of run 1 without measurements, for tests.
    pub fn fixture(lot: &str, seq: u64, verdict: &str) -> Self {
        Self {
            tag: "part",
            lot: lot.to_owned(),
            run: 1,
            rig: None,
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
            external: Vec::new(),
            row: 0,
        }
    }
}
