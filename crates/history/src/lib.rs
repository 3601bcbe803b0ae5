//! History: every lot, part, measurement, reply and alarm of a rig, in one SQLite file.
//!
//! - [`Store`], the only writer, takes records ([`Row`]) in batches, one transaction each: an acknowledged batch
//!   survives power loss ([`Store::trust_the_power`] makes an exception), and a failed batch leaves no row.
//! - [`Archive`] is the reader of the file of a rig, or of a [`Server`] with many rigs. Command line, page and exports
//!   select with the same [`Filter`].
//! - A part has one row: recording the part again adds none; its landing or interruption completes the row. Opening a
//!   lot again adds a run.
//! - Each value is stored with its attempt, limits, uncertainty and budget, and with the raw replies by line, module
//!   and channel. The run names its recipe and calibration by their hashes.
//! - Judging by another recipe writes nothing ([`rejudged`]). Only a run that was copied whole can be deleted
//!   ([`Store::prune`]).
//! - A part that did not pass keeps the sampled curves of its test ([`CurveRecord`]); a batch keeps the curves of its
//!   chamber ([`Batch`]).
//! - Results that a plant measures outside of the rig stand beside the parts ([`ExternalResult`]); a later one supersedes
//!   an earlier one, which stays.
//! - A plan for tooling keeps its steps with the persons who did them ([`tooling`]).
//! - A file belongs to one rig, real or simulated: its first run marks it ([`check_rig`]).
//! - Any SQLite tool can read the file: every column has a remark, and the views `lots`, `parts`, `reasons`,
//!   `measurements`, `samples`, `curves` and `alarms` show local time and names instead of row numbers.
//!
//! The history makes no decisions, computes no statistics (crate `quality` does) and has no clock.
//!
//! ```no_run
//! use history::{Archive, Filter};
//! let archive = Archive::open("relayrig.db".as_ref())?;
//! let failed = Filter {
//!     lot: Some("A".to_owned()),
//!     verdict: Some("fail".to_owned()),
//!     ..Filter::default()
//! };
//! for part in archive.query(&failed)? {
//!     println!("{} went to bin {}", part.seq, part.bin.unwrap_or_default());
//! }
//! # Ok::<(), history::HistoryError>(())
//! ```

pub mod inquiry;
pub mod report;

mod alarm_states;
mod alarms;
mod answers;
mod approval;
mod archive;
mod backup;
mod batches;
pub mod columns;
pub mod csv;
mod curve;
mod decision;
mod details;
mod error;
mod examine;
mod external;
mod filter;
mod gates;
mod import;
mod insert;
mod inside;
mod landing;
mod lot_book;
mod lot_name;
mod lots;
mod moment;
mod open;
mod orders;
pub mod outbox;
mod owner;
mod part;
mod reasons;
mod record;
mod rejudge;
mod reopening;
mod retention;
mod run_end;
mod scans;
mod serials;
mod series;
mod source;
mod store;
pub mod tooling;
mod values;
mod views;
mod wear;

pub use alarm_states::{AlarmChange, AlarmChangeRecord, UnacknowledgedAlarm};
pub use alarms::{Alarm, AlarmState, Shelf};
pub use answers::PromptAnswer;
pub use approval::{SIGNATURES, Signature, signatures};
pub use archive::Archive;
pub use batches::{Batch, BatchAir, BatchRecord, BatchSignal, BatchSocket};
pub use curve::CurveRecord;
pub use decision::Decision;
pub use error::{HistoryError, Result};
pub use examine::{Examination, examine};
pub use external::{
    Entered, EnteredResults, ExternalResult, ExternalStanding, NewResult, ResultRefusal,
    Sample as ExternalSample, parse_results,
};
pub use filter::Filter;
pub use gates::{
    HoldReason, LotState, LotStateRecord, LotStatus, LotYield, ReferenceCheck, ReferenceCheckRecord,
};
pub use import::{ImportError, ImportRow, ignored_columns, parse_records};
pub use inside::InsideRecord;
pub use lot_book::LotEntry;
pub use lot_name::{LOT_NAME, is_lot_name};
pub use lots::{LotSummary, Yield};
pub use moment::{Moment, MomentError};
pub use open::{APPLICATION_ID, SCHEMA, is_in_use, with_end};
pub use orders::{OrderChoice, OrderEntry, OrderRecord, RevisionEntry};
pub use owner::check_rig;
pub use part::{Measurement, Part, Sample};
pub use record::{
    AlarmRecord, CalibratedRecord, CalibrationRecord, InterruptedRecord, LandingRecord, LotRecord,
    MeasurementRecord, PartRecord, Row, SampleRecord, snapshot_hash,
};
pub use rejudge::rejudged;
pub use reopening::{Reopening, ReopeningRecord};
pub use retention::Pruned;
pub use run_end::RunEndRecord;
pub use source::{Receiver, Server, ServerError, Value};
pub use store::Store;
pub use values::{LimitsSeen, Values};
pub use wear::{Wear, WearRecord};

#[cfg(test)]
mod tests;
