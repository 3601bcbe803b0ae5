//! Metrology for every kind of device: readings, uncertainty budgets, means of repetitions, limits.
//!
//! Every result is a [`Reading`]: a value with a [`Budget`] of standard uncertainties after the GUM. This module knows
//! no part, bus, clock or sequence.

pub mod budget;
pub mod evidence;
pub mod factor;
pub mod judgement;
pub mod repetition;

pub use budget::{Budget, Reading};
pub use evidence::Evidence;
pub use factor::{Deviation, Factor};
pub use judgement::{Judgement, Limit, Rule, Side, judge};
