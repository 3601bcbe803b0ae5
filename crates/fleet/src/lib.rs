//! Collects the histories of many rigs in PostgreSQL.
//!
//! - Each rig keeps its own history. The queue of that file ([`history::outbox`]) says what a database lacks.
//! - [`mod@push`] sends a batch in one transaction (binary COPY to staging tables, `INSERT ... ON CONFLICT DO NOTHING`,
//!   commit); then the file confirms the batch. A batch keeps its UUID until the database has said whether it has that
//!   batch ([`handshake`]), so every row arrives once, whichever program dies in between. A batch that did not arrive
//!   comes again with half of its rows.
//! - Batches of a file are numbered without gaps and a number exists once. So two programs, a copied file or a file
//!   from a backup never mix their rows: the database refuses the second sender, with a remedy ([`Refusal`]).
//! - [`Pusher`] sends in a thread of its own; the rig never waits for a database.
//! - [`Reader`] answers the questions of a history over all rigs, or some.
//! - [`overview`] asks what all rigs do and made, for a page that many screens share.
//! - The schema has a comment (`COMMENT ON`) on its tables, monthly partitions, a role that inserts and one that reads
//!   ([`set_up`]).
//!
//! The password comes from the environment or a password file and is never logged.

mod copy;
pub mod differential;
mod error;
pub mod generate;
mod handshake;
mod link;
pub mod overview;
mod password;
mod push;
mod pusher;
mod reader;
mod remedy;
mod sender;
mod session;
mod setup;
mod status;
mod tables;
#[cfg(feature = "fixture")]
pub mod trial;
mod value;

pub use error::{FleetError, Refusal, Result};
pub use handshake::{Facts, Known, Step, next_step};
pub use link::Link;
pub use password::{PasswordFile, password_in};
pub use push::{push, start_again, take_over};
pub use pusher::{Pusher, TargetState, Told};
pub use reader::{Reader, Rigs};
pub use remedy::Remedy;
pub use session::Pushed;
pub use setup::{MONTHS_AHEAD, SCHEMA, Setup, set_up};
pub use status::{Report, report};
