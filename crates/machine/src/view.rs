//! What a screen may know: plain serialisable types, filled by the cycle and the recorder.

mod machine;
mod mimic;
mod motion;
mod order;
mod request;
mod traffic;

pub use machine::{ActuatorView, Button, Machine, Reaction, Token};
pub use mimic::{Mimic, MimicBody};
pub use motion::{MotionView, RefusedView, StrokeView};
pub use order::{Answered, By, LOT_ORDERS, ORDERS, Order};
pub use request::{Answer, OrderRequest};
pub use traffic::{LineTraffic, Message};

use crate::dut::Reason;
use serde::Serialize;
use std::collections::BTreeMap;
use texts::Args;

/// The whole view.
#[derive(Debug, Clone, Default, Serialize)]
pub struct View {
    /// When the turn that is shown was published, by the wall clock whatever the pace: microseconds since 1970 UTC.
    pub at_us: i64,
    /// The rig is simulated.
    pub simulated: bool,
    /// Lot under way, or the last one; empty before the first.
    pub lot: String,
    /// A lot is under way: what is stopped goes on with it.
    pub under_way: bool,
    /// Recipe of the lot.
    pub recipe: String,
    /// What the station is doing, with the stage of a test behind it.
    pub state: String,
    /// The same as a code; empty before the first turn.
    pub doing: String,
    /// Stage of the test under way; null while there is none.
    pub stage: Option<&'static str>,
    /// Parts of the lot judged so far.
    pub judged: u64,
    /// Parts wanted; none for an endless lot.
    pub count: Option<u64>,
    /// Parts between pocket and beam.
    pub inside: u64,
    /// Parts that came in, golden parts included.
    pub came_in: u64,
    /// Parts a beam confirmed, golden parts included.
    pub went_out: u64,
    /// Confirmed parts of the lot by bin.
    pub bins: BTreeMap<String, u64>,
    /// Verdicts of the lot by name.
    pub verdicts: BTreeMap<String, u64>,
    /// Parts per hour of rig time since the lot began.
    pub parts_per_hour: Option<f64>,
    /// The last verdict, kept until the next.
    pub last: Option<LastPart>,
    /// The last twenty parts judged, oldest first.
    pub recent: Vec<RecentPart>,
    /// Limits of the recipe by parameter, low and high; null where there is none.
    pub limits: BTreeMap<String, [Option<f64>; 2]>,
    /// Alarms that stand, first-out first, then in order of coming.
    pub alarms: Vec<AlarmLine>,
    /// How the lines and their modules are doing, since the start.
    pub lines: Vec<LineView>,
    /// Outer machine, buttons, mechanism, signals.
    pub machine: Machine,
    /// How the run of a lot that ended last has ended; none before one has.
    pub last_run: Option<RunEnd>,
}

/// How a run of a lot ended.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct RunEnd {
    /// The lot.
    pub lot: String,
    /// `complete`, `stopped` or `alarm`.
    pub ended: String,
    /// Code of the trouble that ended it: an alarm, or why the program could not go on; none without trouble.
    pub cause: Option<String>,
    /// What happened, English.
    pub cause_text: Option<String>,
}

/// A part in the strip of the last ones.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct RecentPart {
    /// Number in the lot.
    pub seq: u64,
    /// `pass`, `fail`, `void`.
    pub verdict: String,
    /// Bin it goes to.
    pub bin: String,
}

/// The part judged last.
#[derive(Debug, Clone, Default, Serialize)]
pub struct LastPart {
    /// Number in the lot.
    pub seq: u64,
    /// `pass`, `fail`, `void`.
    pub verdict: String,
    /// Bin it goes to.
    pub bin: String,
    /// Why, worst first.
    pub reasons: Vec<String>,
    /// Their codes, in the same order.
    pub reason_codes: Vec<Reason>,
    /// Results by parameter.
    pub values: BTreeMap<String, f64>,
    /// Expanded uncertainties (k = 2) by parameter.
    pub uncertainty: BTreeMap<String, f64>,
}

/// An alarm on a screen.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct AlarmLine {
    /// Short name.
    pub code: String,
    /// Arguments of its text by name.
    pub args: Args,
    /// English text.
    pub text_en: String,
    /// Chinese text.
    pub text_zh: String,
    /// `unacknowledged`, `acknowledged`, `returned`.
    pub state: String,
    /// It began the trouble.
    pub first_out: bool,
    /// How often it came since it was last normal.
    pub count: u32,
    /// When it came first, microseconds since 1970 UTC; null when a run before left it.
    pub raised_at_us: Option<i64>,
    /// Not shown now.
    pub shelved: bool,
    /// What it stops: `abort`, `hold`, `suspend`, `nothing`.
    pub stops: String,
    /// Why, what follows, what to do, English.
    pub help_en: [String; 3],
    /// The same, Chinese.
    pub help_zh: [String; 3],
}

/// A line of modules.
#[derive(Debug, Clone, Default, Serialize)]
pub struct LineView {
    /// As wired.
    pub name: String,
    /// Transactions that found no port.
    pub ports_lost: u64,
    /// In order of addresses.
    pub modules: Vec<ModuleView>,
}

/// How a module is doing: counts since the start.
#[derive(Debug, Clone, Default, Serialize)]
pub struct ModuleView {
    /// Two hexadecimal digits, as on the module.
    pub address: String,
    /// Tries, repeats included.
    pub transactions: u64,
    /// Latency without wire time that half of the replies keep, right within 19 %.
    pub p50_ms: Option<f64>,
    /// The same for 99 of a hundred.
    pub p99_ms: Option<f64>,
    /// Tries without a whole reply in time.
    pub time_outs: u64,
    /// Replies whose characters did not add up.
    pub checksum_errors: u64,
    /// Replies that were wrong in another way.
    pub other_errors: u64,
    /// Answers that said no.
    pub refusals: u64,
    /// Reset status found set.
    pub resets: u64,
}
