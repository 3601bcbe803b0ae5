//! Devices under test: what a part is, how it is measured and judged.
//!
//! A kind of device is one folder. The rest of the program uses [`Recipe`], [`Characteristic`], [`Judgement`],
//! [`Reason`] and [`Verdict`], and names no kind.

pub mod accuracy;
pub mod batch;
pub mod batch_shown;
pub mod calibration;
pub mod card;
pub mod characteristic;
pub mod device;
pub mod em_relay;
pub mod experiment;
pub mod external;
pub mod finding;
pub mod instruments;
pub mod keys;
pub mod made_up;
#[cfg(test)]
pub mod mock;
pub mod procedure;
pub mod promise;
pub mod prompt;
pub mod reason;
pub mod recipe;
pub mod record;
pub mod rejudge;
pub mod resistor;
pub mod ssr;
pub mod thermostat;
pub mod verdict;

pub use crate::gauge::Judgement;
pub use calibration::Calibration;
pub use characteristic::Characteristic;
pub use device::Device;
pub use external::External;
pub use finding::Finding;
pub use procedure::Procedure;
pub use reason::Reason;
pub use recipe::Recipe;
pub use record::TestRecord;
pub use verdict::{Bin, Verdict};

use crate::rig::point::{AnalogInput, Fixture};
use crate::rig::wiring::Wiring;

/// The fixture points that each kind declares.
pub const FIXTURES: &[Fixture] = &[
    em_relay::points::FIXTURE,
    ssr::points::FIXTURE,
    thermostat::points::FIXTURE,
];

/// Returns the inputs that converters read while the references of any kind are measured. If the controller was cut off
/// during that measurement, the channel mask of these inputs is still in their modules.
pub fn reference_inputs(wiring: &Wiring) -> Vec<AnalogInput> {
    em_relay::reference::inputs(wiring)
}

/// Returns the meaning of the bits of a stored signal, highest first; `None` for any other signal.
pub fn bits_of(signal: &str) -> Option<&'static str> {
    (signal == em_relay::points::BOARD).then_some(em_relay::points::BOARD_BITS)
}

/// A kind of device under test.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kind {
    /// Electromagnetic relay: coil, armature, changeover contact.
    EmRelay,
    /// One resistor in a body of relay size, which checks the fixture.
    Resistor,
    /// Solid-state relay: LED, MOSFET or triac output.
    Ssr,
    /// Temperature relay: bimetal switch.
    Thermostat,
}

impl Kind {
    /// Every kind, in the order of its declaration.
    pub const ALL: [Self; 4] = [Self::EmRelay, Self::Resistor, Self::Ssr, Self::Thermostat];
    /// Names of the kinds in recipes, in the order of [`Self::ALL`].
    pub const NAMES: &'static [&'static str] = &[
        Self::EmRelay.name(),
        Self::Resistor.name(),
        Self::Ssr.name(),
        Self::Thermostat.name(),
    ];

    /// Returns the constant data of the kind.
    pub const fn definition(self) -> &'static KindDefinition {
        match self {
            Self::EmRelay => &em_relay::DEFINITION,
            Self::Resistor => &resistor::DEFINITION,
            Self::Ssr => &ssr::DEFINITION,
            Self::Thermostat => &thermostat::DEFINITION,
        }
    }

    /// Returns the name of the kind in recipes.
    pub const fn name(self) -> &'static str {
        self.definition().name
    }

    /// Returns the kind with this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|it| it.name() == name)
    }

    /// Returns the keys that a recipe of this kind may have.
    pub const fn sections(self) -> keys::Sections {
        self.definition().sections
    }

    /// Returns the characteristics of the kind, in the order of reports.
    pub fn characteristics(self) -> Vec<Characteristic> {
        (self.definition().characteristics)()
    }

    /// Returns the findings that only a test of this kind has.
    pub fn findings(self) -> Vec<Finding> {
        (self.definition().findings)()
    }
}

/// Constant data of a kind.
#[derive(Debug, Clone, Copy)]
pub struct KindDefinition {
    /// Name of the kind in recipes.
    pub name: &'static str,
    /// Keys that a recipe may have.
    pub sections: keys::Sections,
    /// Bins of parts that fail, worst first.
    pub bins: &'static [Bin],
    /// Returns the characteristics of the kind, in the order of reports.
    pub characteristics: fn() -> Vec<Characteristic>,
    /// Returns the names of the stages of its test.
    pub stages: fn() -> Vec<&'static str>,
    /// Returns the findings that only a test of this kind has.
    pub findings: fn() -> Vec<Finding>,
}
