//! The state that pages show, as plain serialisable types; the cycle and the recorder of the history fill them.

mod machine;
mod mimic;
mod motion;
mod order;
mod rack;
mod request;
mod traffic;

pub use machine::{ActuatorView, Button, Machine, Reaction, Token};
pub use mimic::{Mimic, MimicBody};
pub use motion::{MotionView, RefusedView, StrokeView};
pub use order::{AnsweredOrder, By, Order};
pub use rack::{RackView, SocketView};
pub use request::{Answer, OrderRequest};
pub use traffic::{LineTraffic, Message};

use crate::dut::Reason;
use serde::Serialize;
use std::collections::BTreeMap;
use texts::Args;
use utoipa::ToSchema;

/// The whole state shown on the page.
#[derive(Debug, Clone, Default, PartialEq, Serialize, ToSchema)]
pub struct View {
    /// Wall-clock time at which the cycle published this view, microseconds since 1970 UTC, whatever the pace of rig
    /// time.
    pub at_us: i64,
    /// True when the rig is simulated.
    pub simulated: bool,
    /// Name of the current lot, or else of the last one; empty before the first.
    pub lot: String,
    /// True while a lot is open; the next start continues a stopped lot.
    pub under_way: bool,
    /// Recipe of the lot.
    pub recipe: String,
    /// Activity of the station, with the stage of a test.
    pub state: String,
    /// Code of the activity; empty before the first turn.
    pub doing: String,
    /// Stage of the test under way; null without a test.
    pub stage: Option<&'static str>,
    /// Parts of the lot judged so far.
    pub judged: u64,
    /// Parts ordered; `None` for an endless lot.
    pub count: Option<u64>,
    /// Parts between pocket and beam.
    pub inside: u64,
    /// Parts fed, reference parts included.
    pub came_in: u64,
    /// Parts confirmed by the beam of a bin, reference parts included.
    pub went_out: u64,
    /// Confirmed parts of the lot by bin.
    pub bins: BTreeMap<String, u64>,
    /// Judged parts of the lot by verdict.
    pub verdicts: BTreeMap<String, u64>,
    /// Parts per hour of rig time since the lot began; null before the first part.
    pub parts_per_hour: Option<f64>,
    /// The last judged part.
    pub last: Option<LastPart>,
    /// The last twenty parts judged, oldest first.
    pub recent: Vec<RecentPart>,
    /// Limits of the recipe by parameter, low and high; null for an open side.
    pub limits: BTreeMap<String, [Option<f64>; 2]>,
    /// Active alarms: first-out first, then in order of occurrence.
    pub alarms: Vec<AlarmLine>,
    /// Health of the lines and their modules, counted since the program started.
    pub lines: Vec<LineView>,
    /// Health of the SCPI instruments, counted since the run began.
    pub instruments: Vec<InstrumentView>,
    /// PackML state, buttons, mechanism, signals.
    pub machine: Machine,
    /// End of the last run of a lot; null before the first.
    pub last_run: Option<RunEnd>,
    /// Rights that the operating system grants to the program, and how late the computer wakes the cycle.
    pub host: HostView,
    /// Databases that collect the histories of many rigs; empty without any.
    pub fleet: Vec<FleetView>,
}

/// State of a database of `fleet.toml`: what it lacks, and the last error.
#[derive(Debug, Clone, Default, PartialEq, Serialize, ToSchema)]
pub struct FleetView {
    /// URL of the database, without password.
    pub url: String,
    /// Number of parts that the database lacks.
    pub lag_parts: u64,
    /// Time since the judgement of the oldest part that the database lacks, s; 0 when it lacks none.
    pub lag_s: f64,
    /// True when the database lacks a part for longer than `alarm_after_s` of `fleet.toml`.
    pub late: bool,
    /// Why the last attempt to send failed, with the remedy; null after one that succeeded.
    pub last_error: Option<String>,
    /// Number of parts sent since the program began.
    pub sent_parts: u64,
}

/// Real-time rights of the program, and its lateness.
#[derive(Debug, Clone, Default, PartialEq, Serialize, ToSchema)]
pub struct HostView {
    /// Priority of the cycle under SCHED_FIFO; null when the system refuses it, or in virtual time.
    pub fifo_priority: Option<u8>,
    /// True when the memory of the program is locked.
    pub memory_locked: bool,
    /// Reasons that the system gives for each right it refuses; empty without a refusal.
    pub refused: Vec<String>,
    /// How late the cycle wakes.
    pub lateness: LatenessView,
}

/// Lateness of the cycle in a run: time from the deadline of a wait to its end.
#[derive(Debug, Clone, Default, PartialEq, Serialize, ToSchema)]
pub struct LatenessView {
    /// Waits counted.
    pub waits: u64,
    /// Median, ms, at most 19 % too high.
    pub p50_ms: f64,
    /// 99th percentile of the lateness, ms, at most 19 % too high.
    pub p99_ms: f64,
    /// 99.9th percentile of the lateness, ms, at most 19 % too high.
    pub p999_ms: f64,
    /// Greatest lateness of the run, ms.
    pub worst_ms: f64,
    /// Greatest lateness of the last one to two seconds, ms.
    pub recent_ms: f64,
    /// Sum over all waits, ms.
    pub sum_ms: f64,
    /// Waits by lateness, edges ascending; a wait later than the last edge is in no bucket.
    pub buckets: Vec<Bucket>,
}

/// Number of waits whose lateness lies above the edge of the previous bucket, up to the edge of this one.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, ToSchema)]
pub struct Bucket {
    /// Edge, ms.
    pub up_to_ms: f64,
    /// Waits in the bucket.
    pub count: u64,
}

/// End of a run of a lot.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, ToSchema)]
pub struct RunEnd {
    /// The lot.
    pub lot: String,
    /// `complete`, `stopped` or `alarm`.
    pub ended: String,
    /// Code of the alarm or program fault that ended the run; null without one.
    pub cause: Option<String>,
    /// Text of the cause, English.
    pub cause_text: Option<String>,
}

/// A part in the list of those judged last.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, ToSchema)]
pub struct RecentPart {
    /// Number in the lot.
    pub seq: u64,
    /// `pass`, `fail`, `void`.
    pub verdict: String,
    /// Bin of the part.
    pub bin: String,
}

/// The part judged last.
#[derive(Debug, Clone, Default, PartialEq, Serialize, ToSchema)]
pub struct LastPart {
    /// Number in the lot.
    pub seq: u64,
    /// `pass`, `fail`, `void`.
    pub verdict: String,
    /// Bin of the part.
    pub bin: String,
    /// Reasons for the verdict, worst first.
    pub reasons: Vec<String>,
    /// Codes of the reasons, in the same order.
    pub reason_codes: Vec<Reason>,
    /// Results by parameter.
    pub values: BTreeMap<String, f64>,
    /// Expanded uncertainties (k = 2) by parameter.
    pub uncertainty: BTreeMap<String, f64>,
}

/// An alarm as pages show it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, ToSchema)]
pub struct AlarmLine {
    /// Code of the alarm.
    pub code: String,
    /// Arguments of its text by name.
    pub args: Args,
    /// English text.
    pub text_en: String,
    /// Chinese text.
    pub text_zh: String,
    /// `unacknowledged`, `acknowledged`, `returned`.
    pub state: String,
    /// True for the alarm whose cause last appeared while no other alarm was active.
    pub first_out: bool,
    /// Occurrences since the alarm was last normal.
    pub count: u32,
    /// Time of the first occurrence, microseconds since 1970 UTC; null when an earlier run left the alarm.
    pub raised_at_us: Option<i64>,
    /// True while the alarm is shelved, that is, hidden until its time is over.
    pub shelved: bool,
    /// Reaction of the station: `abort`, `hold`, `suspend`, `nothing`.
    pub stops: String,
    /// Cause, consequence and action, English.
    pub help_en: [String; 3],
    /// Cause, consequence and action, Chinese.
    pub help_zh: [String; 3],
}

/// A line of modules.
#[derive(Debug, Clone, Default, PartialEq, Serialize, ToSchema)]
pub struct LineView {
    /// Name in the wiring.
    pub name: String,
    /// Transactions that failed because the port was lost.
    pub ports_lost: u64,
    /// Modules in order of address.
    pub modules: Vec<ModuleView>,
}

/// Health of an SCPI instrument, counted since the run began.
#[derive(Debug, Clone, Default, PartialEq, Serialize, ToSchema)]
pub struct InstrumentView {
    /// Name of the instrument in `rig.toml`.
    pub name: String,
    /// Name of the instrument's profile.
    pub profile: String,
    /// Address of its link.
    pub link: String,
    /// Answer of the instrument to `*IDN?`; null before the first answer.
    pub identity: Option<String>,
    /// Programs that have begun, safe programs included.
    pub programs: u64,
    /// Failed programs by the code of the failure.
    pub failures: BTreeMap<String, u64>,
    /// Median time from query to complete reply, ms; at most 19 % too high.
    pub p50_ms: Option<f64>,
    /// 99th percentile of that time, ms; at most 19 % too high.
    pub p99_ms: Option<f64>,
}

/// Health of a module, counted since the program started.
#[derive(Debug, Clone, Default, PartialEq, Serialize, ToSchema)]
pub struct ModuleView {
    /// Address on the line: two hexadecimal digits, as on the module.
    pub address: String,
    /// Tries, repetitions included.
    pub transactions: u64,
    /// Median latency without wire time, ms; the figure is at most 19 % too high.
    pub p50_ms: Option<f64>,
    /// 99th percentile of the latency, ms; the figure is at most 19 % too high.
    pub p99_ms: Option<f64>,
    /// Tries without a complete reply in time.
    pub time_outs: u64,
    /// Replies with a wrong checksum.
    pub checksum_errors: u64,
    /// Replies with any other defect.
    pub other_errors: u64,
    /// Replies in which the module refused the command.
    pub refusals: u64,
    /// Number of times that the module reported a restart.
    pub resets: u64,
}
