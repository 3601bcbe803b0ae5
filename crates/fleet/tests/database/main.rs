//! Tests against a PostgreSQL server of their own: each starts one in a folder of its own and stops it at the end.
//!
//! The tests need the Debian package `postgresql` (15 or later) and fail without it.

#![allow(clippy::unwrap_used)]

mod answers;
mod external;
mod once;
mod overview;
mod plans;
mod proxy;
mod refusals;
mod rig;
mod server;
mod storm;
mod troubles;
