//! From a sample to a verdict: scaling, corrections, uncertainty, limits, guard band.
//!
//! Every result is a [`Reading`]: a value at the reference temperature with a [`Budget`] of standard
//! uncertainties after the GUM. [`verdict`] holds it against its limit; a value that is missing or
//! not finite is never judged. Nothing here knows a bus, a clock or a sequence.
//!
//! | question | file |
//! |---|---|
//! | what is measured, in which unit | [`parameter`] |
//! | what the part must do | [`recipe`] |
//! | how a threshold is found, and whether modules and uncertainty allow it | [`strategy`], [`feasible`] |
//! | how often coil and contacts are read | [`sampling`] |
//! | what the instruments are known to do | [`calibration`], [`settings`] |
//! | coil resistance | [`coil`] |
//! | operate and release voltage | [`threshold`], [`lag`] |
//! | times and bounce | [`timing`] |
//! | contact resistance | [`contact`] |
//! | how sure | [`budget`]; of several readings [`repetition`] |
//! | pass, fail, void; which bin | [`verdict`] |

pub mod budget;
pub mod calibration;
pub mod coil;
pub mod contact;
pub mod feasible;
pub mod lag;
pub mod parameter;
pub mod probe_contact;
pub mod recipe;
pub mod repetition;
pub mod sampling;
pub mod settings;
pub mod strategy;
pub mod threshold;
pub mod timing;
pub mod verdict;

pub use budget::{Budget, Reading};
pub use calibration::Calibration;
pub use parameter::Parameter;
pub use recipe::Recipe;
pub use strategy::Strategy;
pub use verdict::{Bin, Judgement, Verdict};
