//! The one characteristic of a resistor, and its bin.

use crate::dut::characteristic::{
    AcceptedError, Characteristic, Definition, ErrorUnit, KindCharacteristic,
};
use crate::gauge::repetition::MeanOf;
use crate::rig::bin::Bin;
use units::Unit;

/// Bin of a resistor that fails, shared with relay coils.
pub const BIN: Bin = Bin::named("coil");

/// Characteristic of a resistor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Parameter {
    /// DC resistance between the coil pins.
    Resistance,
}

impl Parameter {
    /// Every parameter.
    pub const ALL: [Self; 1] = [Self::Resistance];
}

impl KindCharacteristic for Parameter {
    fn definition(&self) -> &'static Definition {
        match self {
            Self::Resistance => &RESISTANCE,
        }
    }

    fn accepted_error(&self, _rated_v: Option<f64>) -> Option<AcceptedError> {
        match self {
            Self::Resistance => Some(AcceptedError::of(ErrorUnit::Percent, 0.12)),
        }
    }
}

static RESISTANCE: Definition = Definition {
    key: "resistance_ohm",
    unit: Unit::Ohm,
    mean_of: MeanOf::Part,
    bin: BIN,
};

impl From<Parameter> for Characteristic {
    fn from(parameter: Parameter) -> Self {
        Self::Resistor(parameter)
    }
}
