//! Solid-state relay: an LED in front of a MOSFET output, measured with SCPI instruments.
//!
//! | question | file |
//! |---|---|
//! | what is measured, and where a part that fails goes | [`parameter`], [`bins`] |
//! | what the part is, how it is measured | [`recipe`], [`keys`] |
//! | which points and instruments of the rig it needs | [`points`] |
//! | which levels, ranges and times follow from the recipe | [`plan`] |
//! | which programs the instruments run | [`program`] |
//! | how accurate a figure is | [`accuracy`] |
//! | where the edges of a record are | [`edges`] |
//! | how a search finds a threshold, and where it begins | [`search`], [`learned`] |
//! | what a test finds in addition to figures | [`finding`] |
//! | whether a rig can carry out a recipe | [`feasible`] |
//! | the test | [`measure`] |
//! | the process card | [`card`] |

pub mod accuracy;
pub mod bins;
pub mod card;
mod device;
pub mod edges;
pub mod feasible;
pub mod finding;
pub mod keys;
pub mod learned;
pub mod made_up;
pub mod measure;
pub mod parameter;
pub mod plan;
pub mod points;
pub mod program;
pub mod recipe;
pub mod search;

#[cfg(test)]
mod bench;
#[cfg(test)]
mod tests;

pub use device::Device;
pub use finding::Finding;
pub use measure::Test;
pub use parameter::Parameter;

use super::KindDefinition;

/// Constant data of this kind of device.
pub const DEFINITION: KindDefinition = KindDefinition {
    name: "ssr",
    sections: keys::SECTIONS,
    bins: bins::WORST_FIRST,
    characteristics: || Parameter::ALL.map(Into::into).to_vec(),
    stages: || measure::Stage::NAMES.to_vec(),
    findings: || Finding::ALL.map(Into::into).to_vec(),
};
