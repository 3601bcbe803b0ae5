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
//!
//! ```
//! use quality::{Capability, Limits, Spread};
//! let operate_v = Spread::of(&[7.8, 7.9, 7.7, 7.8]);
//! let limits = Limits { low: None, high: Some(9.0) };
//! let sd = operate_v.sd();
//! let capability = Capability::of(limits, operate_v.n(), operate_v.mean(), sd, sd);
//! // The mean is 1.2 V below the limit, and three standard deviations are 0.245 V.
//! assert!(capability.ppk.is_some_and(|it| (it.value - 4.9).abs() < 0.01));
//! ```

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
