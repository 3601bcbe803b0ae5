//! Metrology that every kind of device shares: readings, budgets of uncertainty, means of repetitions, limits.
//!
//! Every result is a [`Reading`]: a value with a [`Budget`] of standard uncertainties after the GUM. Nothing here knows a
//! part, a bus, a clock or a sequence.

pub mod budget;
pub mod factor;
pub mod judgement;
pub mod repetition;

pub use budget::{Budget, Reading};
pub use factor::Factor;
pub use judgement::{Judgement, Limit, Rule, Side, judge};
