//! People, their roles, passwords and sessions.
//!
//! - Reading needs no login; every change needs one. `role.rs` says what each [`Role`] may do.
//! - People and sessions have a file beside the history (`relayrig-access.db` beside `relayrig.db`), because people
//!   copy and mail histories, and must not pass on hashes of passwords with them.
//! - The file holds each password as an Argon2id string (RFC 9106) with its salt and parameters. A session token has
//!   256 random bits; the file holds only its SHA-256, so that a copy of the file opens no session.
//! - While the file holds no engineer, the program prints a [`SetupCode`] at each start; this code adds one engineer.
//! - The file counts wrong passwords (`register/failures.rs`). A login takes the same time for known and unknown names.
//! - `change.rs` changes people and notes each change in the audit of orders, for the page and for the command line.
//!
//! This module does not depend on HTTP; `login.rs` and `people.rs` connect it to HTTP.

mod change;
mod error;
mod password;
mod register;
mod role;
mod setup;

pub(crate) use change::note;
pub use change::{PersonChange, audited};
pub use error::AccessError;
pub use register::{Entry, Login, Person, Register, access_path};
pub use role::Role;
pub use setup::SetupCode;

/// Time after which a session ends, seconds: a shift with its overlaps.
pub const SESSION_S: i64 = 12 * 3600;
