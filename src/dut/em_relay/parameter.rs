//! The nine quantities measured on every part. Their keys are the same in recipes, rows, files and API.

use crate::gauge::repetition::SpokenOf;
use serde::{Deserialize, Serialize};
use std::fmt;

/// One measured quantity. The order is that of reports and of every table kept per parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Parameter {
    /// DC coil resistance at the recipe's reference temperature.
    #[serde(rename = "coil_resistance_ohm")]
    CoilResistance,
    /// Quasi-static must-operate threshold at the reference temperature.
    #[serde(rename = "operate_voltage_v")]
    OperateVoltage,
    /// Quasi-static must-release threshold at the reference temperature.
    #[serde(rename = "release_voltage_v")]
    ReleaseVoltage,
    /// Nominal coil voltage applied to first make of NO, bounce excluded.
    #[serde(rename = "operate_time_ms")]
    OperateTime,
    /// Nominal coil voltage removed to first make of NC, bounce excluded.
    #[serde(rename = "release_time_ms")]
    ReleaseTime,
    /// Total open time of NO after its first make.
    #[serde(rename = "operate_bounce_ms")]
    OperateBounce,
    /// Total open time of NC after its first make.
    #[serde(rename = "release_bounce_ms")]
    ReleaseBounce,
    /// Four-wire resistance of the closed NO contact, thermal EMF removed.
    #[serde(rename = "contact_resistance_no_mohm")]
    ContactResistanceNo,
    /// Four-wire resistance of the closed NC contact, thermal EMF removed.
    #[serde(rename = "contact_resistance_nc_mohm")]
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
    /// The keys of [`Self::ALL`].
    pub const NAMES: [&'static str; 9] = [
        "coil_resistance_ohm",
        "operate_voltage_v",
        "release_voltage_v",
        "operate_time_ms",
        "release_time_ms",
        "operate_bounce_ms",
        "release_bounce_ms",
        "contact_resistance_no_mohm",
        "contact_resistance_nc_mohm",
    ];

    /// The key, with the unit as suffix.
    pub const fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }

    /// The unit in which values and limits are written.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::CoilResistance => "ohm",
            Self::OperateVoltage | Self::ReleaseVoltage => "V",
            Self::OperateTime | Self::ReleaseTime | Self::OperateBounce | Self::ReleaseBounce => {
                "ms"
            }
            Self::ContactResistanceNo | Self::ContactResistanceNc => "mOhm",
        }
    }

    /// What a row with a mean of several readings speaks of.
    pub const fn spoken_of(self) -> SpokenOf {
        match self {
            Self::CoilResistance | Self::OperateVoltage | Self::ReleaseVoltage => SpokenOf::Part,
            Self::OperateTime | Self::ReleaseTime | Self::OperateBounce | Self::ReleaseBounce => {
                SpokenOf::Operation
            }
            Self::ContactResistanceNo | Self::ContactResistanceNc => SpokenOf::Closures,
        }
    }

    /// The parameter of this key.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|parameter| parameter.name() == name)
    }

    /// Position in [`Self::ALL`].
    pub const fn index(self) -> usize {
        self as usize
    }
}

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_key_is_the_same_in_code_and_in_files() {
        for parameter in Parameter::ALL {
            assert_eq!(Parameter::from_name(parameter.name()), Some(parameter));
            assert_eq!(
                serde_json::to_string(&parameter).unwrap(),
                format!("\"{parameter}\"")
            );
            assert_eq!(Parameter::ALL[parameter.index()], parameter);
        }
    }
}
