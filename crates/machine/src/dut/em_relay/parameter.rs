//! The nine characteristics of a relay, as data: a new one is a variant, its place in [`Parameter::ALL`] and a row of the table.

use super::bins;
use super::card::CardStep;
use super::measure::Stage;
use super::threshold::Direction;
use crate::dut::characteristic::{Characteristic, Definition};
use crate::gauge::repetition::SpokenOf;
use std::fmt;
use units::Unit;

/// One measured quantity. The order is that of reports and of every table kept per parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Parameter {
    /// DC coil resistance at the recipe's reference temperature.
    CoilResistance,
    /// Quasi-static must-operate threshold at the reference temperature.
    OperateVoltage,
    /// Quasi-static must-release threshold at the reference temperature.
    ReleaseVoltage,
    /// Nominal coil voltage applied to first make of NO, bounce excluded.
    OperateTime,
    /// Nominal coil voltage removed to first make of NC, bounce excluded.
    ReleaseTime,
    /// Total open time of NO after its first make.
    OperateBounce,
    /// Total open time of NC after its first make.
    ReleaseBounce,
    /// Four-wire resistance of the closed NO contact, thermal EMF removed.
    ContactResistanceNo,
    /// Four-wire resistance of the closed NC contact, thermal EMF removed.
    ContactResistanceNc,
}

impl Parameter {
    /// Every parameter.
    pub const ALL: [Self; 9] = [
        Self::CoilResistance,
        Self::OperateVoltage,
        Self::ReleaseVoltage,
        Self::OperateTime,
        Self::ReleaseTime,
        Self::OperateBounce,
        Self::ReleaseBounce,
        Self::ContactResistanceNo,
        Self::ContactResistanceNc,
    ];

    /// What every kind knows of its characteristics.
    pub const fn definition(self) -> &'static Definition {
        &self.facts().definition
    }

    /// What only relays know of it.
    pub const fn facts(self) -> &'static Facts {
        &TABLE[self as usize]
    }

    /// The key, with the unit as suffix.
    pub const fn name(self) -> &'static str {
        self.definition().key
    }

    /// Position in [`Self::ALL`].
    pub const fn index(self) -> usize {
        self as usize
    }
}

/// What only relays know of a parameter.
#[derive(Debug, Clone, Copy)]
pub struct Facts {
    /// What every kind knows.
    pub definition: Definition,
    /// Goes with the copper of the coil, so that results are brought to the reference temperature.
    pub copper: bool,
    /// Steps of the process card that demand it.
    pub card: &'static [CardStep],
    /// Stage that measures it once more.
    pub stage: Stage,
    /// What a lot is expected to show.
    pub expected: Expected,
    /// Greatest rms error of a lot that is good enough: ohm in percent, V in mV, else in the unit of the key.
    pub allowed_rms: f64,
}

/// What a lot is expected to show of a parameter, in the unit of its key.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Expected {
    /// The nominal coil of the recipe.
    Coil,
    /// The expected threshold of the recipe.
    Threshold(Direction),
    /// The lot of the default world.
    Usual {
        /// Mean of the lot; its median where the logarithm scatters.
        mean: f64,
        /// Standard deviation of the values, or of their logarithm.
        sd: f64,
        /// The logarithm scatters.
        logarithmic: bool,
        /// Standard uncertainty that no strategy takes away.
        u: f64,
    },
}

impl Expected {
    const fn usual(mean: f64, sd: f64, u: f64) -> Self {
        Self::Usual {
            mean,
            sd,
            logarithmic: false,
            u,
        }
    }

    const fn lognormal(mean: f64, sd: f64, u: f64) -> Self {
        Self::Usual {
            mean,
            sd,
            logarithmic: true,
            u,
        }
    }
}

/// In the order of [`Parameter::ALL`].
static TABLE: [Facts; Parameter::ALL.len()] = [
    Facts {
        definition: Definition {
            key: "coil_resistance_ohm",
            unit: Unit::Ohm,
            spoken_of: SpokenOf::Part,
            bin: bins::COIL,
        },
        copper: true,
        card: &[CardStep::Coil],
        stage: Stage::Coil,
        expected: Expected::Coil,
        allowed_rms: 0.12,
    },
    Facts {
        definition: Definition {
            key: "operate_voltage_v",
            unit: Unit::Volt,
            spoken_of: SpokenOf::Part,
            bin: bins::VOLTAGE,
        },
        copper: true,
        card: &[CardStep::OperateVoltage],
        stage: Stage::OperateFine(0),
        expected: Expected::Threshold(Direction::Rising),
        allowed_rms: 9.0,
    },
    Facts {
        definition: Definition {
            key: "release_voltage_v",
            unit: Unit::Volt,
            spoken_of: SpokenOf::Part,
            bin: bins::VOLTAGE,
        },
        copper: true,
        card: &[CardStep::ReleaseVoltage],
        stage: Stage::ReleaseFine(0),
        expected: Expected::Threshold(Direction::Falling),
        allowed_rms: 4.0,
    },
    Facts {
        definition: Definition {
            key: "operate_time_ms",
            unit: Unit::Millisecond,
            spoken_of: SpokenOf::Operation,
            bin: bins::TIME,
        },
        copper: false,
        card: &[CardStep::OperateTime],
        stage: Stage::TimedOperate,
        expected: Expected::usual(4.7, 0.25, 0.008),
        allowed_rms: 0.02,
    },
    Facts {
        definition: Definition {
            key: "release_time_ms",
            unit: Unit::Millisecond,
            spoken_of: SpokenOf::Operation,
            bin: bins::TIME,
        },
        copper: false,
        card: &[CardStep::ReleaseTime],
        stage: Stage::TimedRelease,
        expected: Expected::usual(2.9, 0.15, 0.008),
        allowed_rms: 0.02,
    },
    Facts {
        definition: Definition {
            key: "operate_bounce_ms",
            unit: Unit::Millisecond,
            spoken_of: SpokenOf::Operation,
            bin: bins::TIME,
        },
        copper: false,
        card: &[CardStep::OperateTime],
        stage: Stage::TimedOperate,
        expected: Expected::lognormal(0.4, 0.4, 0.012),
        allowed_rms: 0.05,
    },
    Facts {
        definition: Definition {
            key: "release_bounce_ms",
            unit: Unit::Millisecond,
            spoken_of: SpokenOf::Operation,
            bin: bins::TIME,
        },
        copper: false,
        card: &[CardStep::ReleaseTime],
        stage: Stage::TimedRelease,
        expected: Expected::lognormal(0.5, 0.4, 0.012),
        allowed_rms: 0.05,
    },
    Facts {
        definition: Definition {
            key: "contact_resistance_no_mohm",
            unit: Unit::Milliohm,
            spoken_of: SpokenOf::Closures,
            bin: bins::CONTACT,
        },
        copper: false,
        card: &[CardStep::OperateTime],
        stage: Stage::TimedOperate,
        expected: Expected::lognormal(18.0, 0.25, 0.04),
        allowed_rms: 0.3,
    },
    Facts {
        definition: Definition {
            key: "contact_resistance_nc_mohm",
            unit: Unit::Milliohm,
            spoken_of: SpokenOf::Closures,
            bin: bins::CONTACT,
        },
        copper: false,
        card: &[CardStep::Kelvin, CardStep::ReleaseTime],
        stage: Stage::TimedRelease,
        expected: Expected::lognormal(22.0, 0.25, 0.04),
        allowed_rms: 0.3,
    },
];

impl From<Parameter> for Characteristic {
    fn from(parameter: Parameter) -> Self {
        Self::EmRelay(parameter)
    }
}

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_the_order_of_the_enum() {
        for (place, parameter) in Parameter::ALL.into_iter().enumerate() {
            assert_eq!(parameter.index(), place);
        }
        assert_eq!(Parameter::CoilResistance.name(), "coil_resistance_ohm");
        assert_eq!(
            Parameter::ContactResistanceNc.name(),
            "contact_resistance_nc_mohm"
        );
    }
}
