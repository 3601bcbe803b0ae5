//! Records that the control cycle hands to the history: texts, numbers, reasons and microseconds since 1970 UTC (`_us`).
//!
//! A number that is not finite is stored as null.

use super::{
    AlarmChangeRecord, CurveRecord, InsideRecord, LotStateRecord, OrderRecord,
    ReferenceCheckRecord, ReopeningRecord, RunEndRecord, WearRecord,
};
use machine::dut::Reason;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use texts::Args;

/// A run of a lot. Opening the lot again adds a run with the next number.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct LotRecord {
    /// Name of the lot.
    pub lot: String,
    /// Name of the recipe.
    pub recipe: String,
    /// Text of the recipe, TOML.
    pub recipe_snapshot: String,
    /// Hash of the text, see [`snapshot_hash`]; runs with equal hashes share one stored text.
    pub recipe_hash: String,
    /// Hash of the calibration in force.
    pub calibration_hash: Option<String>,
    /// Start of the run.
    pub opened_at_us: i64,
    /// True on the simulated rig.
    pub simulated: bool,
    /// Seed of the simulated rig.
    pub seed: Option<u64>,
    /// Person who agreed to a retest; `None` for a first test.
    pub retest: Option<String>,
}

/// One judged part with everything measured on it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PartRecord {
    /// The open lot it belongs to.
    pub lot: String,
    /// Count of parts that entered the nest, from 1.
    pub seq: u64,
    /// Serial number, if the part has one.
    pub serial: Option<String>,
    /// `pass`, `fail` or `void`.
    pub verdict: String,
    /// Bin of the verdict; empty for a part that is not sorted.
    pub bin: String,
    /// Reasons against a pass, the decisive one first.
    pub reasons: Vec<Reason>,
    /// Time of the verdict.
    pub judged_at_us: i64,
    /// Time from probes up to verdict, rig seconds; NaN for an import.
    pub test_s: f64,
    /// Time since the previous nest exit, rig seconds; `None` until it is known, at the landing at the latest.
    pub cycle_s: Option<f64>,
    /// Bin whose beam confirmed the part.
    pub landed_bin: Option<String>,
    /// Time of that confirmation.
    pub landed_at_us: Option<i64>,
    /// `lot` for a production part, `golden` for a reference part; each kind counts its own `seq`.
    pub kind: String,
    /// Measurements in order of time; a repetition has a higher attempt.
    pub measurements: Vec<MeasurementRecord>,
    /// Sampled curves; empty for a part that passed.
    pub curves: Vec<CurveRecord>,
}

/// One attempt to measure one parameter.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct MeasurementRecord {
    /// Parameter key with unit suffix, `operate_voltage_v`.
    pub key: String,
    /// Value in the unit of the key; `None` without a usable value.
    pub value: Option<f64>,
    /// Expanded uncertainty, k = 2, same unit.
    pub uncertainty: Option<f64>,
    /// Lower limit of the recipe.
    pub low: Option<f64>,
    /// Upper limit of the recipe.
    pub high: Option<f64>,
    /// Verdict of this attempt: `pass`, `fail` or `void`.
    pub verdict: String,
    /// Number of the attempt, from 1; statistics use the last one.
    pub attempt: u32,
    /// Uncertainty budget as JSON text.
    pub budget: Option<String>,
    /// Replies that the value was computed from.
    pub samples: Vec<SampleRecord>,
}

/// A reply of a module.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct SampleRecord {
    /// Name of the serial line.
    pub line: String,
    /// Address of the module, two hexadecimal digits.
    pub module: String,
    /// Channel; empty for a reply about the whole module.
    pub channel: String,
    /// Text sent, without the carriage return.
    pub command: String,
    /// Text received, without the carriage return.
    pub raw: String,
    /// Time of the last byte.
    pub at_us: i64,
}

/// The beam of a bin confirms a part.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct LandingRecord {
    /// The open lot it belongs to.
    pub lot: String,
    /// `lot` or `golden`.
    pub kind: String,
    /// Number of the part.
    pub seq: u64,
    /// Bin of the beam.
    pub bin: String,
    /// Time of the confirmation.
    pub at_us: i64,
    /// Time since the previous nest exit, rig seconds, if known.
    pub cycle_s: Option<f64>,
}

/// A judged part is interrupted on its way: its row becomes void with bin `retest` and keeps its values.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InterruptedRecord {
    /// The open lot it belongs to.
    pub lot: String,
    /// `lot` or `golden`.
    pub kind: String,
    /// Number of the part.
    pub seq: u64,
    /// Reason that is added to the row.
    pub reason: Reason,
}

/// An occurrence of an alarm; recorded again with `cleared_at_us` when it is cleared.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct AlarmRecord {
    /// The open lot at that time, if any.
    pub lot: Option<String>,
    /// Code of the alarm.
    pub code: String,
    /// Serial line that it concerns, if any.
    pub line: Option<String>,
    /// Message in English.
    pub text: String,
    /// Arguments of the message by name.
    pub args: Args,
    /// Time of the alarm.
    pub raised_at_us: i64,
    /// Time at which it was cleared.
    pub cleared_at_us: Option<i64>,
}

/// Calibration factors, valid from `made_at_us` to `due_at_us`.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct CalibrationRecord {
    /// Time of the calibration.
    pub made_at_us: i64,
    /// End of validity.
    pub due_at_us: i64,
    /// Hash of the body, see [`snapshot_hash`].
    pub hash: String,
    /// Factors with uncertainties, JSON text.
    pub body: String,
    /// True unless the last verification failed.
    pub verified: bool,
}

/// Reference parts have calibrated the rig during the run of a lot.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CalibratedRecord {
    /// The open lot at that time.
    pub lot: String,
    /// The calibration that the run uses from now on.
    pub calibration: CalibrationRecord,
}

/// A record of the control cycle.
#[derive(Debug, Clone, PartialEq)]
pub enum Row {
    /// A run of a lot begins.
    Run(LotRecord),
    /// The run has a new calibration.
    Calibrated(CalibratedRecord),
    /// A judged part.
    Part(PartRecord),
    /// A part whose beam has confirmed it.
    Landed(LandingRecord),
    /// A judged part that was interrupted.
    Interrupted(InterruptedRecord),
    /// An alarm that was raised or cleared.
    Alarm(AlarmRecord),
    /// An alarm that was acknowledged, shelved or returned.
    AlarmChange(AlarmChangeRecord),
    /// The end of a run.
    RunEnded(RunEndRecord),
    /// A new state of a lot.
    LotState(LotStateRecord),
    /// A complete lot that is opened again.
    Reopened(ReopeningRecord),
    /// A check of reference parts against their certificates.
    ReferenceCheck(ReferenceCheckRecord),
    /// An order with its answer.
    Order(OrderRecord),
    /// Uses of a wearing part.
    Wear(WearRecord),
    /// Places of parts inside the machine.
    Inside(InsideRecord),
}

/// Returns the SHA-256 of a text, hexadecimal.
pub fn snapshot_hash(text: impl AsRef<[u8]>) -> String {
    Sha256::digest(text.as_ref())
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect()
}
