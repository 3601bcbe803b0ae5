//! Temperature relays: bimetal switches, all tested together in a chamber.
//!
//! A batch heats and cools all parts through the windows in which they switch, in one pass or more. The contacts give
//! the instants of switching; the record of the reference thermometer, corrected for the lag of the parts, gives the
//! temperatures (crate `chamber`).
//!
//! | question | file |
//! |---|---|
//! | what is measured, and on which list a part that fails leaves | [`parameter`] |
//! | what the part is, how it is measured | [`recipe`] |
//! | what the rig must have for it | [`feasible`] |
//! | how long a batch takes | [`duration`] |
//! | which points of the rig it needs | [`points`] |
//! | why a part fails or stays unjudged, besides its figures | [`finding`] |
//! | the keys of its recipe and of the certificate | [`keys`] |
//! | calibration of thermometer chain and sockets | [`certificate`] |
//! | date of that calibration | [`issued`] |
//! | response of the chamber, as a file states it | [`response`] |
//! | what a batch learns for the next one: chamber, lag of the lot | [`device`] |
//! | the test of a batch | [`measure`] |
//! | the process card | [`card`] |

pub mod card;
pub mod certificate;
pub mod device;
pub mod duration;
pub mod feasible;
pub mod finding;
pub mod issued;
pub mod keys;
pub mod made_up;
pub mod measure;
pub mod parameter;
pub mod points;
pub mod recipe;
pub mod response;

pub use device::Device;
pub use finding::Finding;
pub use parameter::Parameter;

use super::KindDefinition;

/// Constant data of this kind of device.
pub const DEFINITION: KindDefinition = KindDefinition {
    name: "thermostat",
    sections: keys::SECTIONS,
    bins: &[parameter::CONTACT, parameter::TEMPERATURE, parameter::SNAP],
    characteristics: || Parameter::ALL.map(Into::into).to_vec(),
    stages: || measure::Stage::NAMES.to_vec(),
    findings: || Finding::all().map(Into::into).collect(),
};
