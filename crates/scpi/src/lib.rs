//! SCPI, the protocol of measuring instruments, over streams and Prologix-type GPIB adapters: one query at a time, in
//! bounded time, and never a reply that belongs to another query. This crate has neither clock nor stream;
//! `bus::instrument` adds them.
//!
//! A [`Program`] is a list of commands and queries; the link delivers all of its values or none.
//!
//! ```
//! use scpi::{Form, number, ErrorEntry, ReplyError};
//!
//! assert_eq!(number("+1.5E+00"), Ok(1.5));
//! assert_eq!(number("9.9E37"), Err(ReplyError::OverRange), "never a value");
//! assert_eq!(ErrorEntry::read("-113,\"Undefined header\"").map(|it| it.code), Ok(-113));
//! ```
//!
//! # Why a reply belongs to its query
//!
//! A stream keeps the order of its bytes, but no reply carries a number. So the link relies on the order and proves it:
//!
//! 1. At most one query is outstanding. Bytes before a query, or after its reply, are a failure.
//! 2. Every program ends with the error queue, read until it is empty, with `*ESR?`, which shows a loss of power, and
//!    with `*ESE?`: the instrument must return the number that the previous program left there. Each number differs
//!    from the last 127, so a reply too many or too few puts another reply in its place.
//! 3. A reply that equals the previous reply may be a copy of it, so the link repeats the query once.
//! 4. After a failure that leaves doubt, the link delivers nothing before a resynchronisation: a new connection (serial
//!    ports: the end of a message; adapters: a device clear), silence, two numbers through `*ESE` with every other
//!    reply discarded, the same identity as before, `*ESR?` for a loss of power, `*CLS`, and the whole set-up again.
//!    The resynchronisation begins with the next program, so that a caller can first open a contactor.
//! 5. Behind an adapter each message carries the GPIB address of the instrument, and after each message the adapter
//!    states the address that it uses.
//!
//! No host can notice a number that lost digits and kept its end of line, or a lost command without a query that reads
//! the setting back ([`Step::Ask`] with `expect`).
//!
//! # Files
//!
//! | file | what it does |
//! |---|---|
//! | `reply.rs`, `status.rs` | numbers, strings, blocks; error queue, event register, identity |
//! | `reader.rs` | cuts bytes into replies, with a bound on each |
//! | `program.rs`, `profile.rs` | programs; instrument profiles that build them |
//! | `session.rs`, `run.rs`, `nonce.rs` | the state machine of a link; the run of a program; numbers that prove the step |
//! | `framing.rs`, `address.rs`, `settings.rs` | terminators and adapters; addresses; times |
//! | `waveform.rs` | samples of a digitizer |
//! | `accuracy.rs` | how far an instrument may err |
//! | `failure.rs` | every reason why there is no value |

mod accuracy;
mod address;
mod failure;
mod framing;
mod nonce;
mod profile;
mod program;
mod reader;
mod reply;
mod run;
mod session;
mod settings;
mod status;
mod waveform;

#[cfg(test)]
mod tests;

pub use accuracy::{Accuracy, Quantity, range};
pub use address::{Flow, LinkAddress, LinkAddressError, Transport};
pub use failure::Failure;
pub use framing::{Framing, Terminator};
pub use profile::{Profile, ProfileFault, ProgramError};
pub use program::{Program, Step};
pub use reader::Reader;
pub use reply::{BLOCK_LIMIT, Form, LINE_LIMIT, Raw, Reply, ReplyError, number, string};
pub use session::{Move, Question, Session};
pub use settings::{Echo, ExpectedIdentity, LinkSettings};
pub use status::{ErrorClass, ErrorEntry, Identity, StandardEvents};
pub use waveform::{Dialect, Samples, SamplesError, samples};

/// Makes `cargo test` compile the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
