//! Resistor: a fixture check, and the smallest kind there is.
//!
//! A dummy of relay size holds one resistor between the two coil pins. The rig feeds, clamps, measures and sorts it
//! like any part, which checks feeder, probes and supply with one characteristic on one channel. Voltage and current
//! have the makers' accuracies: the kind needs neither references nor reference parts.
//!
//! | question | file |
//! |---|---|
//! | what is measured, and where a part that fails goes | [`parameter`] |
//! | what the part is, how it is measured | [`recipe`] |
//! | which points of the rig it needs | [`points`] |
//! | how accurate the figure is | [`accuracy`] |
//! | what a test finds in addition to the figure | [`finding`] |
//! | the keys of its recipe | [`keys`] |
//! | the test | [`measure`] |
//! | the process card | [`card`] |

pub mod accuracy;
pub mod card;
pub mod finding;
pub mod keys;
pub mod made_up;
pub mod measure;
pub mod parameter;
pub mod points;
pub mod recipe;

pub use finding::Finding;
pub use measure::{Device, Test};
pub use parameter::Parameter;

use super::KindDefinition;

/// Constant data of this kind of device.
pub const DEFINITION: KindDefinition = KindDefinition {
    name: "resistor",
    sections: keys::SECTIONS,
    bins: &[parameter::BIN],
    characteristics: || Parameter::ALL.map(Into::into).to_vec(),
    stages: || measure::Stage::ALL.map(measure::Stage::name).to_vec(),
    findings: || Finding::ALL.map(Into::into).to_vec(),
};
