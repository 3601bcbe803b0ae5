//! Plain records that the cycle hands to the history.
//!
//! They know nothing of the station or of a kind of device: texts, numbers, reasons and integer microseconds UTC. A
//! number that is not finite is stored as no number at all.

use super::{
    AlarmChangeRecord, CurveRecord, InsideRecord, LotStateRecord, OrderRecord,
    ReferenceCheckRecord, RunEndRecord, WearRecord,
};
use machine::dut::Reason;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use texts::Args;

/// One opening of a lot. A lot opened again gets the next run number; nothing is overwritten.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct LotRecord {
    /// What the operator called the lot.
    pub lot: String,
    /// Name of the recipe.
    pub recipe: String,
    /// The recipe as it is in force, TOML.
    pub recipe_snapshot: String,
    /// Hash of the snapshot, see [`snapshot_hash`]; equal hashes share one stored text.
    pub recipe_hash: String,
    /// Hash of the calibration in force.
    pub calibration_hash: Option<String>,
    /// Begin of the run.
    pub opened_at_us: i64,
    /// Whether the rig is the simulated one.
    pub simulated: bool,
    /// Seed of the simulated rig.
    pub seed: Option<u64>,
    /// Of a run that tests parts of the lot again: who agreed to it.
    pub retest: Option<String>,
}

/// One judged part with everything measured on it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PartRecord {
    /// The open lot it belongs to.
    pub lot: String,
    /// Count of parts that entered the nest, from 1.
    pub seq: u64,
    /// Serial number when the part has one.
    pub serial: Option<String>,
    /// `pass`, `fail` or `void`.
    pub verdict: String,
    /// The bin the verdict asks for; empty when it is not to be sorted.
    pub bin: String,
    /// Why it is not a pass, the decisive reason first.
    pub reasons: Vec<Reason>,
    /// When the verdict stood.
    pub judged_at_us: i64,
    /// Probes up to verdict, rig seconds; not a number when unknown (imports).
    pub test_s: f64,
    /// Since the previous nest exit, rig seconds; often known only with the landing.
    pub cycle_s: Option<f64>,
    /// The bin whose beam saw it fall.
    pub landed_bin: Option<String>,
    /// When the beam saw it.
    pub landed_at_us: Option<i64>,
    /// `lot` for production, `golden` for a reference part; each kind counts its own `seq`.
    pub kind: String,
    /// In the order they were made; a repeated one has a higher attempt.
    pub measurements: Vec<MeasurementRecord>,
    /// What was seen of it; none of a part that passed.
    pub curves: Vec<CurveRecord>,
}

/// One attempt to measure one parameter.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct MeasurementRecord {
    /// Parameter key with its unit as suffix, `operate_voltage_v`.
    pub key: String,
    /// In the unit of the key; none when the measurement stayed unset.
    pub value: Option<f64>,
    /// Expanded uncertainty, k = 2, same unit.
    pub uncertainty: Option<f64>,
    /// Lower limit of the recipe.
    pub low: Option<f64>,
    /// Upper limit of the recipe.
    pub high: Option<f64>,
    /// `pass`, `fail` or `void`, of this attempt alone.
    pub verdict: String,
    /// 1, or more when measured again; statistics count the highest.
    pub attempt: u32,
    /// Uncertainty budget as JSON text.
    pub budget: Option<String>,
    /// The replies the value was made of.
    pub samples: Vec<SampleRecord>,
}

/// One reply of a module, as it came over the line.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct SampleRecord {
    /// Name of the serial line.
    pub line: String,
    /// Address of the module on its line, as on the wire.
    pub module: String,
    /// Channel; empty when the reply is of the whole module.
    pub channel: String,
    /// Text sent, without the carriage return.
    pub command: String,
    /// Text received, without the carriage return.
    pub raw: String,
    /// When the reply was complete.
    pub at_us: i64,
}

/// A part seen by the beam of a bin.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct LandingRecord {
    /// The open lot it belongs to.
    pub lot: String,
    /// `lot` or `golden`.
    pub kind: String,
    /// The part.
    pub seq: u64,
    /// The bin whose beam saw it.
    pub bin: String,
    /// When.
    pub at_us: i64,
    /// Since the previous nest exit, rig seconds, when it is known by now.
    pub cycle_s: Option<f64>,
}

/// A part that was judged and then interrupted on its way: void, to retest; its values stay.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InterruptedRecord {
    /// The open lot it belongs to.
    pub lot: String,
    /// `lot` or `golden`.
    pub kind: String,
    /// The part.
    pub seq: u64,
    /// Added to its reasons.
    pub reason: Reason,
}

/// One occurrence of an alarm; recorded again with `cleared_at_us` when it goes.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct AlarmRecord {
    /// The open lot it happened in, if any.
    pub lot: Option<String>,
    /// What kind of trouble.
    pub code: String,
    /// Serial line, when it concerns one.
    pub line: Option<String>,
    /// The message as shown, English.
    pub text: String,
    /// Arguments of the message by name.
    pub args: Args,
    /// When it came.
    pub raised_at_us: i64,
    /// When it went.
    pub cleared_at_us: Option<i64>,
}

/// Calibration factors in force from `made_at_us` on.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct CalibrationRecord {
    /// When the factors were determined.
    pub made_at_us: i64,
    /// When they stop being valid.
    pub due_at_us: i64,
    /// Hash of the body, see [`snapshot_hash`].
    pub hash: String,
    /// Factors with uncertainties, JSON text.
    pub body: String,
    /// Whether a verification after it passed.
    pub verified: bool,
}

/// What one turn of the rig may ask to be kept.
#[derive(Debug, Clone, PartialEq)]
pub enum Row {
    /// A judged part.
    Part(PartRecord),
    /// A part that reached a bin.
    Landed(LandingRecord),
    /// A judged part that goes to retest all the same.
    Interrupted(InterruptedRecord),
    /// An alarm that came, or went.
    Alarm(AlarmRecord),
    /// What became of an alarm.
    AlarmChange(AlarmChangeRecord),
    /// A run of a lot has ended.
    RunEnded(RunEndRecord),
    /// A lot changes its state.
    LotState(LotStateRecord),
    /// Golden parts were compared with their certificates.
    ReferenceCheck(ReferenceCheckRecord),
    /// An order with its answer.
    Order(OrderRecord),
    /// Uses of what wears.
    Wear(WearRecord),
    /// What the next run has to look for.
    Inside(InsideRecord),
}

/// SHA-256 of a snapshot's text, hexadecimal: the name under which it is stored once.
pub fn snapshot_hash(text: impl AsRef<[u8]>) -> String {
    Sha256::digest(text.as_ref())
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect()
}
