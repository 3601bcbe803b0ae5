//! Resistor: a fixture check, and the smallest kind there is.
//!
//! A dummy of relay size holds one resistor between the two coil pins. The rig feeds, clamps, measures and sorts it
//! like any part, which checks feeder, probes and supply with one characteristic on one channel. Voltage and current
//! have the makers' accuracies: the kind needs neither references nor reference parts.
//!
//! | file | holds |
//! |---|---|
//! | `mod` | [`DEFINITION`]: name, keys, characteristics, stages, findings |
//! | [`parameter`] | characteristics as data, bins: `KindCharacteristic` |
//! | [`finding`] | findings without a value (such as "open"), each with its code, its bin and the limit that it proves exceeded |
//! | [`keys`] | keys of `[part]`, `[limits]` and `[test]` with unit and range |
//! | [`recipe`] | the recipe as types, and the check that the rig can carry it out: `KindRecipe` |
//! | [`points`] | points that the test needs, looked up by name |
//! | [`measure`] | [`Device`], which outlives a part, and [`Test`] of one part: `DeviceUnderTest`, `TestProcedure` |
//! | [`accuracy`] | uncertainty of a result |
//! | [`card`] | process card |
//! | [`made_up`] | statistics of a lot, for made-up parts |

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
