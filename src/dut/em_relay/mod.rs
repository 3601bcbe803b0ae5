//! Electromagnetic relay: coil, armature, one changeover contact.
//!
//! | question | file |
//! |---|---|
//! | what is measured, in which unit | [`parameter`] |
//! | where a part that fails goes | [`bins`] |
//! | the order of a test, a file per stage | [`measure`] |
//! | how a threshold is found, and whether modules and uncertainty allow it | [`strategy`], [`feasible`] |
//! | how often coil and contacts are read | [`sampling`] |
//! | what the instruments are known to do | [`calibration`], [`settings`] |
//! | how the factors are found: board references, reference parts | [`reference`], [`golden`] |
//! | coil resistance | [`coil`] |
//! | operate and release voltage | [`threshold`], [`lag`], [`supply`] |
//! | times and bounce | [`timing`] |
//! | contact resistance | [`contact`] |
//! | contact of the probes at the coil | [`probe_contact`] |

pub mod bins;
pub mod calibration;
pub mod coil;
pub mod contact;
pub mod feasible;
pub mod golden;
pub mod lag;
pub mod measure;
pub mod parameter;
pub mod probe_contact;
pub mod reference;
pub mod sampling;
pub mod settings;
pub mod strategy;
pub mod supply;
pub mod threshold;
pub mod timing;

pub use calibration::Calibration;
pub use parameter::Parameter;
pub use strategy::Strategy;
