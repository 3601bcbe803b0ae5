//! History: what was measured on which part, kept for good in one SQLite file.
//!
//! - [`Store`] is the one writer. It takes plain records ([`Row`]) in batches, one transaction each;
//!   a batch that was acknowledged survives power loss, a batch that failed left nothing.
//! - [`Archive`] is a reader. One [`Filter`] serves command line, screens and sheets.
//! - A row is written once. The same part twice is no second row; a lot opened again gets a new run.
//! - What a number was made of travels with it: attempt, limits, uncertainty and its budget, and the
//!   raw replies with line, module and channel. The recipe and the calibration in force are found
//!   from the run by their hashes.
//! - What another recipe would say is told and not written ([`rejudged`]); what was copied whole may be
//!   pruned ([`Store::prune`]), nothing else is ever deleted.
//! - Of a part that did not pass everything that was seen of it stays, as small blobs ([`CurveRecord`]).
//! - The file may be opened by hand: the tables carry a remark per column, and the views `lots`,
//!   `parts`, `reasons`, `measurements`, `samples`, `curves` and `alarms` show local time and names instead of numbers.
//!
//! Not here: deciding anything (gauge, station), statistics (quality), a clock.

pub mod inquiry;
pub mod report;

mod alarm_states;
mod alarms;
mod archive;
mod backup;
pub mod columns;
pub mod csv;
mod curve;
mod decision;
mod error;
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
mod part;
mod reasons;
mod record;
mod rejudge;
mod retention;
mod run_end;
mod series;
mod store;
mod values;
mod views;
mod wear;

pub use alarm_states::{AlarmChange, AlarmChangeRecord, AlarmLeft};
pub use alarms::{Alarm, AlarmState, Shelf};
pub use archive::Archive;
pub use curve::CurveRecord;
pub use decision::Decision;
pub use error::{HistoryError, Result};
pub use filter::Filter;
pub use gates::{
    LotStanding, LotState, LotStateRecord, LotYield, ReferenceCheck, ReferenceCheckRecord,
};
pub use import::{ImportError, ImportRow, parse_import, parse_records};
pub use inside::InsideRecord;
pub use lot_book::LotLine;
pub use lot_name::{LOT_NAME, is_lot_name};
pub use lots::{LotSummary, Passed, Yield};
pub use moment::{Moment, MomentError};
pub use open::{APPLICATION_ID, SCHEMA};
pub use orders::{OrderRecord, Ordered};
pub use part::{Measurement, Part, Sample};
pub use record::{
    AlarmRecord, CalibrationRecord, InterruptedRecord, LandingRecord, LotRecord, MeasurementRecord,
    PartRecord, Row, SampleRecord, snapshot_hash,
};
pub use rejudge::rejudged;
pub use retention::Pruned;
pub use run_end::RunEndRecord;
pub use store::{Identity, Store};
pub use values::{LimitsSeen, Values};
pub use wear::{Wear, WearRecord};

#[cfg(test)]
mod tests;
