//! Statistics of quality: arithmetic only, without clock or files.
//!
//! - [`spread`]: mean, standard deviation and lag-1 autocorrelation, accurate even when the values differ only in their
//!   last digits. [`ordered`]: quantiles, histogram.
//! - [`capability`]: capability indices of a process, with confidence intervals.
//! - [`chart`]: control charts. [`rules`]: patterns of points that are unlikely by chance.
//! - [`equality`]: tests whether groups of values, such as lots, have the same mean and the same spread.
//! - [`effectiveness`]: overall equipment effectiveness and losses of time.
//! - [`summary`]: mean, spread and capability of one parameter, as `history stats` prints them.
//! - [`tally`]: mean, spread and histogram of values that arrive one at a time.
//! - [`gauge_rr`], [`average_range`]: how much of the observed variation the gauge causes.

pub mod average_range;
pub mod capability;
pub mod chart;
mod crossing;
mod double;
pub mod effectiveness;
pub mod equality;
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
