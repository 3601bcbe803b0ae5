//! The nine characteristics of a relay, as data. `docs/extending.md` lists what else a new one needs.

use super::card::CardStep;
use super::coil::to_reference;
use super::measure::Stage;
use super::threshold::Direction;
use super::{bins, evidence};
use crate::dut::characteristic::{
    AcceptedError, Characteristic, Definition, ErrorUnit, KindCharacteristic,
};
use crate::gauge::repetition::MeanOf;
use crate::instrument::curve::Curve;
use crate::rig::bin::Bin;
use std::fmt;
use units::{Celsius, Unit};

/// One measured quantity. The order is that of reports and of every table kept per parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Parameter {
    /// DC coil resistance at the recipe's reference temperature.
    CoilResistance,
    /// Quasi-static operate (pick-up) voltage at the reference temperature.
    OperateVoltage,
    /// Quasi-static release (drop-out) voltage at the reference temperature.
    ReleaseVoltage,
    /// Time from switching nominal voltage onto the coil to the first make of NO, bounce excluded.
    OperateTime,
    /// Time from taking nominal voltage off the coil to the first make of NC, bounce excluded.
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
    /// Every parameter, in the order of reports.
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

    /// Returns the data that only parameters of relays have.
    pub const fn facts(self) -> &'static Facts {
        &TABLE[self as usize]
    }

    /// Returns the key, with the unit as suffix.
    pub const fn name(self) -> &'static str {
        self.facts().definition.key
    }

    /// Returns the position in [`Self::ALL`].
    pub const fn index(self) -> usize {
        self as usize
    }
}

/// Data that only parameters of relays have.
#[derive(Debug, Clone, Copy)]
pub struct Facts {
    /// Key, unit and bin, as for every kind of device.
    pub definition: Definition,
    /// True when the parameter scales with the copper of the coil: results are converted to the reference temperature.
    pub copper: bool,
    /// Steps of the process card that list its limits.
    pub card: &'static [CardStep],
    /// Stage that confirmation measurements repeat for this parameter.
    pub stage: Stage,
    /// Expected distribution over a lot.
    pub expected: Expected,
    /// Greatest acceptable rms error over a lot: in percent of the value for a resistance in ohm, in percent of the
    /// nominal coil voltage for a voltage, else in the unit of the key.
    pub allowed_rms: f64,
}

/// Expected distribution of a parameter over a lot, in the unit of its key.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Expected {
    /// Around the nominal coil resistance of the recipe.
    Coil,
    /// Around the expected threshold of the recipe.
    Threshold(Direction),
    /// Distribution of the lot in the default simulated world.
    Usual {
        /// Mean of the lot; its median when `logarithmic`.
        mean: f64,
        /// Standard deviation of the values, or of their logarithm.
        sd: f64,
        /// True when the logarithm is normally distributed.
        logarithmic: bool,
        /// Standard uncertainty that every strategy has at least.
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

impl Facts {
    const fn of(
        key: &'static str,
        (unit, mean_of, bin): (Unit, MeanOf, Bin),
        (card, stage): (&'static [CardStep], Stage),
        expected: Expected,
        allowed_rms: f64,
    ) -> Self {
        Self {
            definition: Definition {
                key,
                unit,
                mean_of,
                bin,
            },
            copper: matches!(expected, Expected::Coil | Expected::Threshold(_)),
            card,
            stage,
            expected,
            allowed_rms,
        }
    }
}

const TIME: (Unit, MeanOf, Bin) = (Unit::Millisecond, MeanOf::Operation, bins::TIME);
const CONTACT: (Unit, MeanOf, Bin) = (Unit::Milliohm, MeanOf::Closures, bins::CONTACT);
const COIL: (Unit, MeanOf, Bin) = (Unit::Ohm, MeanOf::Part, bins::COIL);
const VOLTAGE: (Unit, MeanOf, Bin) = (Unit::Volt, MeanOf::Part, bins::VOLTAGE);
const RISING: (&[CardStep], Stage) = (&[CardStep::OperateVoltage], Stage::OperateFine(0));
const FALLING: (&[CardStep], Stage) = (&[CardStep::ReleaseVoltage], Stage::ReleaseFine(0));
const OPERATE: (&[CardStep], Stage) = (&[CardStep::OperateTime], Stage::TimedOperate);
const RELEASE: (&[CardStep], Stage) = (&[CardStep::ReleaseTime], Stage::TimedRelease);
const NC: (&[CardStep], Stage) = (
    &[CardStep::Kelvin, CardStep::ReleaseTime],
    Stage::TimedRelease,
);

/// Facts in the order of [`Parameter::ALL`].
#[rustfmt::skip]
static TABLE: [Facts; Parameter::ALL.len()] = [
    Facts::of("coil_resistance_ohm", COIL, (&[CardStep::Coil], Stage::Coil), Expected::Coil, 0.12),
    Facts::of("operate_voltage_v", VOLTAGE, RISING, Expected::Threshold(Direction::Rising), 0.075),
    Facts::of("release_voltage_v", VOLTAGE, FALLING, Expected::Threshold(Direction::Falling), 0.03333),
    Facts::of("operate_time_ms", TIME, OPERATE, Expected::usual(4.7, 0.25, 0.008), 0.02),
    Facts::of("release_time_ms", TIME, RELEASE, Expected::usual(2.9, 0.15, 0.008), 0.02),
    Facts::of("operate_bounce_ms", TIME, OPERATE, Expected::lognormal(0.4, 0.4, 0.012), 0.05),
    Facts::of("release_bounce_ms", TIME, RELEASE, Expected::lognormal(0.5, 0.4, 0.012), 0.05),
    Facts::of("contact_resistance_no_mohm", CONTACT, OPERATE, Expected::lognormal(18.0, 0.25, 0.04), 0.3),
    Facts::of("contact_resistance_nc_mohm", CONTACT, NC, Expected::lognormal(22.0, 0.25, 0.04), 0.3),
];

impl KindCharacteristic for Parameter {
    fn definition(&self) -> &'static Definition {
        &self.facts().definition
    }

    /// Returns the conversion factor of copper; 1 for results that do not depend on the copper of the coil.
    fn conversion(&self, from: Celsius, to: Celsius) -> f64 {
        match self.facts().copper {
            true => to_reference(from, to),
            false => 1.0,
        }
    }

    fn accepted_error(&self, rated_v: Option<f64>) -> Option<AcceptedError> {
        let Facts {
            definition,
            allowed_rms,
            ..
        } = *self.facts();
        let (unit, rms) = if definition.unit == Unit::Ohm {
            (ErrorUnit::Percent, allowed_rms)
        } else if definition.unit == Unit::Volt {
            let share_v = allowed_rms * rated_v?;
            (ErrorUnit::Millivolt, (share_v * 1e4).round() / 1e3)
        } else {
            (ErrorUnit::Own, allowed_rms)
        };
        Some(AcceptedError::of(unit, rms))
    }

    fn lower_bound(&self, curves: &[Curve], rated_v: Option<f64>) -> Option<f64> {
        let bound = evidence::at_least(curves, *self, rated_v?);
        bound.map(|bound| bound * (1.0 - evidence::DOUBT))
    }
}

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
