//! Quality: figures about many values. Pure arithmetic, no clock, no file.
//!
//! - [`spread`]: mean, standard deviation, lag-1 autocorrelation, right to the digits that the data
//!   allow even when the values differ in their last places only.
//! - [`capability`]: is the process able to keep the limits, and how sure is that.
//! - [`summary`]: both for one parameter, as `history stats` shows them.
//! - [`gauge_rr`]: how much of what is seen comes from the gauge and not from the parts.

pub mod capability;
mod crossing;
mod double;
pub mod fisher;
pub mod gauge_rr;
pub mod spread;
mod squares;
pub mod summary;

pub use capability::{Capability, Limits};
pub use gauge_rr::{GaugeRr, GaugeRrError, Reading};
pub use spread::Spread;
pub use summary::Summary;
