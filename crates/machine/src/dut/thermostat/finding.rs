//! Findings of a batch of temperature relays other than figures.

use super::parameter::{CONTACT, TEMPERATURE};
use crate::dut::batch::BatchTrouble;
use crate::dut::finding::Entry;
use chamber::watch::Trouble;

/// Why a part fails, why it could not be judged, or which trouble of the chamber ended the batch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Finding {
    /// The contact is open before the batch is heated.
    OpenCold,
    /// The contact opens or closes for a moment, several times, without switching.
    Intermittent,
    /// The contact stays closed although the air passes the whole operate window.
    NeverOperates,
    /// The contact stays open although the air passes the whole reset window.
    NeverResets,
    /// The part lags far more than the others of its lot.
    Slow,
    /// The contact switches outside the record of the thermometer.
    NoTemperature,
    /// A reading of the contact resistance has no value.
    DropNotReadable,
    /// A thermometer of the chamber has no reading.
    SensorBroken,
    /// A thermometer of the chamber moves faster than the air can.
    SensorJump,
    /// The thermometers of the chamber disagree.
    SensorsDiffer,
    /// A thermometer of the chamber stands still under power.
    SensorStuck,
    /// The slope of the temperature does not fit the power.
    EnergyBalance,
    /// The chamber warms without power.
    HeatWithoutCommand,
    /// The chamber is far above its set point.
    OverSetPoint,
    /// The chamber does not follow the rate of the pass.
    RampNotReached,
    /// The chamber does not cool.
    CoolingTooSlow,
    /// The slope of a referee test exceeds the limit of the recipe.
    RampTooFast,
    /// The identification of the chamber gives no result.
    NotIdentified,
    /// The limiter on the heater has tripped.
    LimiterTripped,
    /// The airflow switch is open.
    AirflowLost,
    /// The mains of the heater have failed.
    MainsLost,
}

impl Finding {
    /// Every finding.
    pub const ALL: [Self; 21] = [
        Self::OpenCold,
        Self::Intermittent,
        Self::NeverOperates,
        Self::NeverResets,
        Self::Slow,
        Self::NoTemperature,
        Self::DropNotReadable,
        Self::SensorBroken,
        Self::SensorJump,
        Self::SensorsDiffer,
        Self::SensorStuck,
        Self::EnergyBalance,
        Self::HeatWithoutCommand,
        Self::OverSetPoint,
        Self::RampNotReached,
        Self::CoolingTooSlow,
        Self::RampTooFast,
        Self::NotIdentified,
        Self::LimiterTripped,
        Self::AirflowLost,
        Self::MainsLost,
    ];

    /// Returns the code of the finding and its consequence for the part: failed or void, and its list.
    pub fn entry(self) -> Entry {
        match self {
            Self::OpenCold => Entry::fail("thermostat_open_cold", CONTACT),
            Self::Intermittent => Entry::fail("thermostat_intermittent", CONTACT),
            Self::NeverOperates => Entry::fail("thermostat_never_operates", TEMPERATURE),
            Self::NeverResets => Entry::fail("thermostat_never_resets", TEMPERATURE),
            Self::Slow => Entry::fail("thermostat_slow", TEMPERATURE),
            Self::NoTemperature => Entry::void("thermostat_no_temperature"),
            Self::DropNotReadable => Entry::void("thermostat_drop_not_readable"),
            Self::SensorBroken => Entry::void("chamber_sensor_broken"),
            Self::SensorJump => Entry::void("chamber_sensor_jump"),
            Self::SensorsDiffer => Entry::void("chamber_sensors_differ"),
            Self::SensorStuck => Entry::void("chamber_sensor_stuck"),
            Self::EnergyBalance => Entry::void("chamber_energy_balance"),
            Self::HeatWithoutCommand => Entry::void("chamber_heat_without_command"),
            Self::OverSetPoint => Entry::void("chamber_over_set_point"),
            Self::RampNotReached => Entry::void("chamber_ramp_not_reached"),
            Self::CoolingTooSlow => Entry::void("chamber_cooling_too_slow"),
            Self::RampTooFast => Entry::void("chamber_ramp_too_fast"),
            Self::NotIdentified => Entry::void("chamber_not_identified"),
            Self::LimiterTripped => Entry::void("chamber_limiter_tripped"),
            Self::AirflowLost => Entry::void("chamber_airflow_lost"),
            Self::MainsLost => Entry::void("chamber_mains_lost"),
        }
    }

    /// Returns the trouble of the rig that the finding is; `None` for a finding about parts.
    pub fn trouble(self) -> Option<BatchTrouble> {
        let trouble = match self {
            Self::OpenCold
            | Self::Intermittent
            | Self::NeverOperates
            | Self::NeverResets
            | Self::Slow
            | Self::NoTemperature
            | Self::DropNotReadable => return None,
            Self::SensorBroken => BatchTrouble::ThermometerBroken,
            Self::SensorJump => BatchTrouble::ThermometerJump,
            Self::SensorsDiffer => BatchTrouble::ThermometersDiffer,
            Self::SensorStuck => BatchTrouble::ThermometerStuck,
            Self::EnergyBalance => BatchTrouble::EnergyBalance,
            Self::HeatWithoutCommand => BatchTrouble::HeatWithoutCommand,
            Self::OverSetPoint => BatchTrouble::OverSetPoint,
            Self::RampNotReached => BatchTrouble::RampNotReached,
            Self::CoolingTooSlow => BatchTrouble::CoolingTooSlow,
            Self::RampTooFast => BatchTrouble::RampTooFast,
            Self::NotIdentified => BatchTrouble::NotIdentified,
            Self::LimiterTripped => BatchTrouble::LimiterTripped,
            Self::AirflowLost => BatchTrouble::AirflowLost,
            Self::MainsLost => BatchTrouble::MainsLost,
        };
        Some(trouble)
    }
}

impl From<Trouble> for Finding {
    fn from(trouble: Trouble) -> Self {
        match trouble {
            Trouble::SensorBroken => Self::SensorBroken,
            Trouble::SensorJump => Self::SensorJump,
            Trouble::SensorsDiffer => Self::SensorsDiffer,
            Trouble::SensorStuck => Self::SensorStuck,
            Trouble::EnergyBalance => Self::EnergyBalance,
            Trouble::HeatWithoutCommand => Self::HeatWithoutCommand,
            Trouble::OverSetPoint => Self::OverSetPoint,
            Trouble::RampNotReached => Self::RampNotReached,
            Trouble::CoolingTooSlow => Self::CoolingTooSlow,
        }
    }
}
