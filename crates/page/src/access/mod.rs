//! Who may order what: people, passwords, sessions.
//!
//! - A stranger looks. Whoever wants something done logs in; what a [`Role`] may do is in `role.rs`.
//! - People and sessions stand in a file of their own beside the history (`relayrig-access.db` beside
//!   `relayrig.db`): a history is copied, mailed and backed up, hashes of passwords are not.
//! - Passwords are kept as Argon2id strings (RFC 9106) with their own salt and parameters. Sessions
//!   are 256 random bits; the file keeps only their SHA-256, so that a copied file opens no session.
//! - A file without people gets one engineer with a random password, which is told once.
//! - Wrong passwords are counted per name and in all (`limiter.rs`); a name that does not exist costs
//!   the same time as one that does.
//!
//! Nothing here knows HTTP; `login.rs` of the screen does.

mod error;
mod limiter;
mod password;
mod register;
mod role;

pub use error::AccessError;
pub(crate) use limiter::Limiter;
pub use register::{Person, Register, beside};
pub use role::Role;

/// How long a session lasts: a shift with its overlaps. Seconds.
pub const SESSION_S: i64 = 12 * 3600;
