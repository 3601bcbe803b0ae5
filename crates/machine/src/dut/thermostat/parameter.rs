//! Characteristics of a temperature relay, and the lists on which a part that fails leaves the rack.

use crate::dut::characteristic::{
    AcceptedError, Characteristic, Definition, ErrorUnit, KindCharacteristic,
};
use crate::gauge::repetition::MeanOf;
use crate::rig::bin::Bin;
use units::Unit;

/// List of parts with a faulty contact; some relay kinds have a bin of the same name.
pub const CONTACT: Bin = Bin::named("contact");
/// List of parts that switch at a wrong temperature, or not at all.
pub const TEMPERATURE: Bin = Bin::named("temperature");
/// List of parts that chatter or scatter.
pub const SNAP: Bin = Bin::named("snap");

/// Characteristic of a temperature relay.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Parameter {
    /// Temperature at which the contact opens while it rises.
    Operate,
    /// Temperature at which the contact closes while it falls.
    Reset,
    /// Operate temperature minus reset temperature of the same part.
    Differential,
    /// Resistance of the closed contact, four-wire, before the batch is heated.
    Contact,
    /// Width over which the contact opens: from the doubling of its resistance to its opening; 0 for a snap.
    Creep,
    /// Greatest number of edges of the contact in one switching beyond the one it needs; 0 for a clean snap.
    Chatter,
    /// Range of a switching temperature over the passes; the wider one of operate and reset.
    Repeatability,
}

impl Parameter {
    /// Every parameter.
    pub const ALL: [Self; 7] = [
        Self::Operate,
        Self::Reset,
        Self::Differential,
        Self::Contact,
        Self::Creep,
        Self::Chatter,
        Self::Repeatability,
    ];
}

impl KindCharacteristic for Parameter {
    fn definition(&self) -> &'static Definition {
        match self {
            Self::Operate => &OPERATE,
            Self::Reset => &RESET,
            Self::Differential => &DIFFERENTIAL,
            Self::Contact => &CONTACT_RESISTANCE,
            Self::Creep => &CREEP,
            Self::Chatter => &CHATTER,
            Self::Repeatability => &REPEATABILITY,
        }
    }

    fn accepted_error(&self, _rated_v: Option<f64>) -> Option<AcceptedError> {
        let rms = match self {
            Self::Operate | Self::Reset => 0.36,
            Self::Differential => 0.5,
            Self::Contact => 1.5,
            Self::Creep | Self::Chatter | Self::Repeatability => return None,
        };
        Some(AcceptedError::of(ErrorUnit::Own, rms))
    }
}

const fn definition(key: &'static str, unit: Unit, bin: Bin) -> Definition {
    Definition {
        key,
        unit,
        mean_of: MeanOf::Part,
        bin,
    }
}

static OPERATE: Definition = definition("operate_temperature_c", Unit::Celsius, TEMPERATURE);
static RESET: Definition = definition("reset_temperature_c", Unit::Celsius, TEMPERATURE);
static DIFFERENTIAL: Definition = definition("differential_k", Unit::Kelvin, TEMPERATURE);
static CONTACT_RESISTANCE: Definition =
    definition("contact_resistance_mohm", Unit::Milliohm, CONTACT);
static CREEP: Definition = definition("creep_k", Unit::Kelvin, SNAP);
static CHATTER: Definition = definition("chatter_edges", Unit::One, SNAP);
static REPEATABILITY: Definition = definition("repeatability_k", Unit::Kelvin, SNAP);

impl From<Parameter> for Characteristic {
    fn from(parameter: Parameter) -> Self {
        Self::Thermostat(parameter)
    }
}
