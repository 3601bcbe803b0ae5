//! Solid-state relay: an LED in front of a MOSFET or triac output, measured with SCPI instruments.
//!
//! | question | file |
//! |---|---|
//! | what is measured, and where a part that fails goes | [`parameter`], [`bins`] |
//! | what the part is, how it is measured | [`recipe`], [`keys`] |
//! | which points and instruments of the rig it needs | [`points`] |
//! | which levels, ranges and times follow from the recipe | [`plan`] |
//! | which programs the instruments run | [`program`] |
//! | which levels, scales and times follow for an AC load | [`ac_plan`] |
//! | how accurate a figure is | [`accuracy`], [`ac_accuracy`] |
//! | which errors of the digitizer the references of the fixture reveal | [`references`] |
//! | where the edges of a record are, which instants the curves mark | [`edges`], [`marks`] |
//! | what a record of line or loop shows | [`wave`] |
//! | how a search finds a threshold, and where it begins | [`search`], [`learned`] |
//! | why a part fails or stays unjudged, besides its figures | [`finding`] |
//! | whether a rig can carry out a recipe | [`feasible`] |
//! | the test | [`measure`] |
//! | the process card | [`card`] |

pub mod ac_accuracy;
pub mod ac_plan;
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
mod marks;
pub mod measure;
pub mod parameter;
pub mod plan;
pub mod points;
pub mod program;
pub mod recipe;
pub mod references;
pub mod search;
pub mod wave;

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
    stages: || measure::Label::ALL.map(measure::Label::name).to_vec(),
    findings: || Finding::ALL.map(Into::into).to_vec(),
};
