//! People, their roles, passwords and sessions.
//!
//! - Reading needs no login; every change needs one. `role.rs` says what each [`Role`] may do.
//! - People and sessions have a file beside the history (`relayrig-access.db` beside `relayrig.db`), because histories
//!   are copied, mailed and backed up, and hashes of passwords must not be.
//! - The file holds each password as an Argon2id string (RFC 9106) with its salt and parameters. A session token has
//!   256 random bits; the file holds only its SHA-256, so that a copy of the file opens no session.
//! - A file without people gets one engineer with a random password, which the program prints once.
//! - `limiter.rs` counts wrong passwords. A login takes the same time for known and unknown names.
//!
//! This module does not depend on HTTP; `login.rs` does.

mod error;
mod limiter;
mod password;
mod register;
mod role;

pub use error::AccessError;
pub(crate) use limiter::Limiter;
pub use register::{Person, Register, access_path};
pub use role::Role;

/// Time after which a session ends, seconds: a shift with its overlaps.
pub const SESSION_S: i64 = 12 * 3600;
