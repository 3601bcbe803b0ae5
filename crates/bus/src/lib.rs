//! A line of modules: one transaction at a time, in bounded time, and never a neighbour's answer.
//!
//! One task owns one port ([`run`]). A request goes in, exactly one [`Answer`] comes out, in the same order. A transaction:
//!
//! 1. What lies in the input is thrown away: it belongs to nobody.
//! 2. The request is written. The reply has wire(request) + wire(longest reply) + allowance to arrive whole.
//! 3. The line rests for the turnaround (two characters). A byte in that time means that somebody else is
//!    talking, and the reply is not believed.
//! 4. After a time-out or any damage the module is asked to name itself: its `!AA` reply proves that nothing older is
//!    on its way. If it does not, the line must fall silent for the longest reply time and the grace for late
//!    replies, and for a second whatever could be the reply that is owed needs a confirmation (`owing.rs`): `>`
//!    replies carry no address, and a late one must not be taken for the next.
//! 5. An address whose reply was damaged is heard twice for a while (`trust.rs`): where checksums fail, one in 256 passes.
//! 6. Only commands that change nothing are repeated, and at most as often as the request allows.
//! 7. What writes a setting to the EEPROM asks for it first, and is not sent when it stands already.
//!
//! Troubles: a line that never falls silent answers [`LineError::NeverSilent`]; a lost port answers
//! [`LineError::PortLost`] at the pace of a silent module, and is reopened with back-off.
//!
//! `pace.rs` is the only place that knows how rig time maps to the timers; `wire.rs` how long characters take;
//! `trace.rs` keeps the last bytes, `recorded.rs` writes them down; `health.rs` counts.

mod answer;
mod exchange;
mod health;
mod line;
mod log;
mod meaning;
mod owing;
mod pace;
mod port;
mod raw;
mod recorded;
mod settings;
mod talk;
mod trace;
mod trust;
mod wire;

#[cfg(test)]
mod tests;

pub use answer::{Answer, LineError, Request};
pub use health::{Health, Histogram, ModuleHealth};
pub use line::{Ports, run, run_reopening};
pub use log::LineLog;
pub use meaning::Meaning;
pub use pace::Pace;
pub use port::{PortError, SerialPorts, open_serial};
pub use raw::{RawReply, send_raw};
pub use recorded::{Recorded, RecordedError, arrow, escaped, unescaped};
pub use settings::{LineSettings, longest_transaction};
pub use trace::{Direction, Entry, Trace};
pub use trust::PROBATION;
pub use wire::Wire;
