//! Quality: figures about many values. Pure arithmetic, no clock, no file.
//!
//! - [`spread`]: mean, standard deviation, lag-1 autocorrelation, right to the digits that the data
//!   allow even when the values differ in their last places only. [`ordered`]: quantiles, histogram.
//! - [`capability`]: is the process able to keep the limits, and how sure is that.
//! - [`chart`]: control charts; [`rules`]: when their points are no longer chance.
//! - [`effectiveness`]: how much of the time made good parts, and where the rest went.
//! - [`summary`]: moments and capability of one parameter, as `history stats` shows them.
//! - [`tally`]: moments and histogram of values that come one at a time.
//! - [`gauge_rr`], [`average_range`]: how much of what is seen comes from the gauge, not from the parts.

pub mod average_range;
pub mod capability;
pub mod chart;
mod crossing;
mod double;
pub mod effectiveness;
pub mod gauge_rr;
pub mod ordered;
pub mod rules;
pub mod spread;
mod squares;
pub mod summary;
pub mod tally;

pub use capability::{Capability, Limits};
pub use gauge_rr::{GaugeRr, GaugeRrError, Reading};
pub use ordered::Ordered;
pub use spread::Spread;
pub use summary::Summary;
