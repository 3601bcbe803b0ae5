//! Records that the control cycle hands to the history: texts, numbers and reasons. A field whose name ends in `_us`
//! holds an instant, in microseconds since 1970 UTC.
//!
//! A number that is not finite is stored as null.

use super::{
    AlarmChangeRecord, BatchRecord, CurveRecord, InsideRecord, LotStateRecord, OrderRecord,
    ReferenceCheckRecord, ReopeningRecord, RunEndRecord, WearRecord,
};
use data_encoding::HEXLOWER;
use machine::dut::Reason;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use texts::Args;

/// A run of a lot. Opening the same lot again adds a run with the next number.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct LotRecord {
    /// Name of the lot.
    pub lot: String,
    /// Name of the recipe.
    pub recipe: String,
    /// Text of the recipe, TOML.
    pub recipe_snapshot: String,
    /// Hash of `recipe_snapshot`, made by [`snapshot_hash`]; runs with equal hashes share one stored text.
    pub recipe_hash: String,
    /// Hash of the calibration in force, if any.
    pub calibration_hash: Option<String>,
    /// Start of the run.
    pub opened_at_us: i64,
    /// True on the simulated rig.
    pub simulated: bool,
    /// Seed of the simulated rig; `None` on a real one.
    pub seed: Option<u64>,
    /// Person who agreed to a retest; `None` for a first test.
    pub retest: Option<String>,
}

/// One judged part with everything measured on it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PartRecord {
    /// Name of the part's lot, of which a run is open.
    pub lot: String,
    /// Number of the part, from 1: it was the `seq`-th of its kind to enter the nest in this run.
    pub seq: u64,
    /// Serial number, if the part has one.
    pub serial: Option<String>,
    /// `pass`, `fail` or `void`.
    pub verdict: String,
    /// Bin that the verdict assigns; empty for a part that is not sorted.
    pub bin: String,
    /// Reasons why the part did not pass, the decisive one first.
    pub reasons: Vec<Reason>,
    /// Time of the verdict.
    pub judged_at_us: i64,
    /// Time from the raising of the probes to the verdict, seconds of rig time (simulated time on a simulated rig); NaN
    /// for an import.
    pub test_s: f64,
    /// Time since the previous part left the nest, seconds of rig time; `None` while unknown: the [`LandingRecord`] may
    /// still add it.
    pub cycle_s: Option<f64>,
    /// Bin whose beam saw the part fall; `None` until then.
    pub landed_bin: Option<String>,
    /// Time at which the beam of `landed_bin` saw the part.
    pub landed_at_us: Option<i64>,
    /// `lot` for a production part, `golden` for a reference part; the parts of each kind are numbered from 1.
    pub kind: String,
    /// Measurements in order of time; when one is repeated, the repetition has a higher attempt number.
    pub measurements: Vec<MeasurementRecord>,
    /// Sampled curves; empty for a part that passed.
    pub curves: Vec<CurveRecord>,
}

/// One attempt at measuring one parameter.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct MeasurementRecord {
    /// Key of the parameter, which ends with its unit, for example `operate_voltage_v`.
    pub key: String,
    /// Value, in the unit that the key names; `None` without a usable value.
    pub value: Option<f64>,
    /// Expanded uncertainty (k = 2), in the unit of `value`.
    pub uncertainty: Option<f64>,
    /// Lower limit of the recipe, if any.
    pub low: Option<f64>,
    /// Upper limit of the recipe, if any.
    pub high: Option<f64>,
    /// Verdict of this attempt: `pass`, `fail` or `void`.
    pub verdict: String,
    /// Number of the attempt, from 1; statistics use the last one.
    pub attempt: u32,
    /// Uncertainty budget, as JSON text.
    pub budget: Option<String>,
    /// Replies from which the value was computed.
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
    /// Request as sent, without the carriage return.
    pub command: String,
    /// Reply as received, without the carriage return.
    pub raw: String,
    /// Time at which the last byte of the reply arrived.
    pub at_us: i64,
}

/// The beam of a bin saw a part fall.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct LandingRecord {
    /// Name of the part's lot, of which a run is open.
    pub lot: String,
    /// `lot` for a production part, `golden` for a reference part.
    pub kind: String,
    /// Number of the part.
    pub seq: u64,
    /// Bin whose beam saw the part.
    pub bin: String,
    /// Time at which the beam saw the part.
    pub at_us: i64,
    /// Time since the previous part left the nest, seconds of rig time; `None` while it is unknown.
    pub cycle_s: Option<f64>,
}

/// A judged part was interrupted on its way to the bin: its row becomes void, gets bin `retest` and keeps its values.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InterruptedRecord {
    /// Name of the part's lot, of which a run is open.
    pub lot: String,
    /// `lot` for a production part, `golden` for a reference part.
    pub kind: String,
    /// Number of the part.
    pub seq: u64,
    /// Reason that is added to the row.
    pub reason: Reason,
}

/// An occurrence of an alarm; when the alarm is cleared, it is recorded again with `cleared_at_us`.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct AlarmRecord {
    /// Name of the lot whose run was open at that time, if any.
    pub lot: Option<String>,
    /// Code of the alarm.
    pub code: String,
    /// Serial line that the alarm is about, if any.
    pub line: Option<String>,
    /// Message in English.
    pub text: String,
    /// Arguments of the message by name.
    pub args: Args,
    /// Time at which the alarm was raised.
    pub raised_at_us: i64,
    /// Time at which the cause was gone; `None` while the alarm is active.
    pub cleared_at_us: Option<i64>,
}

/// Calibration factors, valid from `made_at_us` to `due_at_us`.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct CalibrationRecord {
    /// Time of the calibration.
    pub made_at_us: i64,
    /// Time at which the factors expire.
    pub due_at_us: i64,
    /// Hash of `body`, made by [`snapshot_hash`].
    pub hash: String,
    /// Factors with uncertainties, JSON text.
    pub body: String,
    /// False after a failed verification, else true.
    pub verified: bool,
}

impl CalibrationRecord {
    /// Returns true when the calibration has expired at `now_us`, microseconds since 1970 UTC.
    pub const fn is_overdue(&self, now_us: i64) -> bool {
        self.due_at_us <= now_us
    }
}

/// Reference parts have calibrated the rig during the run of a lot.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CalibratedRecord {
    /// Name of the lot whose run is open.
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
    /// A batch whose test has ended.
    Batch(BatchRecord),
    /// A part that the beam of a bin saw.
    Landed(LandingRecord),
    /// A judged part that was interrupted.
    Interrupted(InterruptedRecord),
    /// An alarm that was raised or cleared.
    Alarm(AlarmRecord),
    /// An alarm whose state changed: returned, acknowledged or shelved.
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
    /// Increase of the use count of a wearing part.
    Wear(WearRecord),
    /// Places of parts inside the machine.
    Inside(InsideRecord),
}

/// Returns the SHA-256 of a text as hexadecimal digits.
pub fn snapshot_hash(text: impl AsRef<[u8]>) -> String {
    HEXLOWER.encode(&Sha256::digest(text))
}
