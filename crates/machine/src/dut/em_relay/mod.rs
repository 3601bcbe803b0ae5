//! Electromagnetic relay: coil, armature, one changeover contact.
//!
//! | question | file |
//! |---|---|
//! | data that outlives one part: recipe, factors, what the device has learned | [`device`] |
//! | what is measured, in which unit | [`parameter`] |
//! | where a part that fails goes | [`bins`] |
//! | what the part is, how it is measured | [`recipe`] |
//! | which keys the files of `config/` may have | [`keys`] |
//! | what a test finds in addition to figures | [`finding`] |
//! | the order of a test, a file per stage | [`measure`] |
//! | how a threshold is found, and whether modules and uncertainty allow it | [`strategy`], [`feasible`] |
//! | which points a rig must have, and how acts and readings name them | [`points`], [`act`], [`readings`] |
//! | how often coil and contacts are read | [`sampling`] |
//! | how accurate the instruments are | [`calibration`], [`settings`] |
//! | how the factors are found: board references, reference parts | [`mod@reference`], [`reference_part`] |
//! | coil resistance | [`coil`] |
//! | operate and release voltage | [`threshold`], [`overshoot`], [`supply`] |
//! | voltages of any coil in any supply range | [`scale`] |
//! | times and bounce | [`timing`] |
//! | contact resistance | [`contact`] |
//! | contact of the probes at the coil | [`probe_contact`] |
//! | whether the rig keeps what its file promises | [`promise`] |
//! | what curves prove of a part without a value | [`evidence`] |
//! | lines of the process card | [`card`] |
//! | figures of made-up relays, for trying a history | [`made_up`] |

pub mod act;
pub mod bins;
pub mod calibration;
pub mod card;
pub mod coil;
pub mod contact;
pub mod device;
pub mod evidence;
pub mod feasible;
pub mod finding;
pub mod keys;
pub mod made_up;
pub mod measure;
pub mod overshoot;
pub mod parameter;
pub mod points;
pub mod probe_contact;
pub mod promise;
pub mod readings;
pub mod recipe;
pub mod reference;
pub mod reference_part;
pub mod sampling;
pub mod scale;
pub mod settings;
pub mod strategy;
pub mod supply;
pub mod threshold;
pub mod timing;

pub use calibration::Calibration;
pub use device::Device;
pub use finding::Finding;
pub use measure::Observed;
pub use parameter::Parameter;
pub use strategy::Strategy;

use super::KindDefinition;

/// Constant data of this kind of device.
pub const DEFINITION: KindDefinition = KindDefinition {
    name: "em_relay",
    sections: keys::recipe::SECTIONS,
    bins: &bins::BY_RANK,
    characteristics: || Parameter::ALL.map(Into::into).to_vec(),
    stages: || measure::Stage::ALL.map(measure::Stage::name).to_vec(),
    findings: || Finding::ALL.map(Into::into).to_vec(),
};

#[cfg(test)]
pub(crate) mod tests;
