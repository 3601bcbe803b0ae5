//! Results that a plant measures outside of the rig, on samples of a lot ([`External`](machine::dut::External)).
//!
//! [`Store::enter_results`](super::Store::enter_results) takes them, typed in or from the records of a file
//! ([`parse_results`]), all or none. The recipe with which the lot was run judges them. A row never changes: a later
//! result on the same sample and quantity supersedes the earlier one, and both remain to be seen.
//!
//! A lot is acceptable when each quantity that its recipe demands has a result and all results that count pass
//! ([`ExternalStanding`]).

mod enter;
mod parse;
mod read;

pub use enter::{Entered, EnteredResults, NewResult, ResultRefusal, Sample};
pub use parse::parse_results;
pub use read::{ExternalResult, ExternalStanding};
