//! Findings of a batch of temperature relays other than figures.

use super::parameter::{CONTACT, TEMPERATURE};
use crate::dut::batch::{BatchTrouble, HeatTrouble};
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
    /// The chamber is in trouble.
    Heat(HeatTrouble),
}

/// Findings about parts.
const OF_PARTS: [Finding; 7] = [
    Finding::OpenCold,
    Finding::Intermittent,
    Finding::NeverOperates,
    Finding::NeverResets,
    Finding::Slow,
    Finding::NoTemperature,
    Finding::DropNotReadable,
];

impl Finding {
    /// Yields every finding.
    pub fn all() -> impl Iterator<Item = Self> {
        let of_rig = HeatTrouble::ALL.iter().copied().map(Self::Heat);
        OF_PARTS.into_iter().chain(of_rig)
    }

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
            Self::Heat(trouble) => Entry::void(reason(trouble)),
        }
    }

    /// Returns the trouble of the rig that the finding is; `None` for a finding about parts.
    pub fn trouble(self) -> Option<BatchTrouble> {
        match self {
            Self::OpenCold
            | Self::Intermittent
            | Self::NeverOperates
            | Self::NeverResets
            | Self::Slow
            | Self::NoTemperature
            | Self::DropNotReadable => None,
            Self::Heat(trouble) => Some(BatchTrouble::Heat(trouble)),
        }
    }
}

/// Returns the code of the reason why a part was not judged.
fn reason(trouble: HeatTrouble) -> &'static str {
    match trouble {
        HeatTrouble::ThermometerBroken => "chamber_sensor_broken",
        HeatTrouble::ThermometerJump => "chamber_sensor_jump",
        HeatTrouble::ThermometersDiffer => "chamber_sensors_differ",
        HeatTrouble::ThermometerStuck => "chamber_sensor_stuck",
        HeatTrouble::EnergyBalance => "chamber_energy_balance",
        HeatTrouble::HeatWithoutCommand => "chamber_heat_without_command",
        HeatTrouble::OverSetPoint => "chamber_over_set_point",
        HeatTrouble::RampNotReached => "chamber_ramp_not_reached",
        HeatTrouble::CoolingTooSlow => "chamber_cooling_too_slow",
        HeatTrouble::RampTooFast => "chamber_ramp_too_fast",
        HeatTrouble::NotIdentified => "chamber_not_identified",
        HeatTrouble::LimiterTripped => "chamber_limiter_tripped",
        HeatTrouble::AirflowLost => "chamber_airflow_lost",
        HeatTrouble::MainsLost => "chamber_mains_lost",
        HeatTrouble::ChainNotRead => "chamber_chain_not_read",
    }
}

impl From<HeatTrouble> for Finding {
    fn from(trouble: HeatTrouble) -> Self {
        Self::Heat(trouble)
    }
}

impl From<Trouble> for Finding {
    fn from(trouble: Trouble) -> Self {
        Self::Heat(match trouble {
            Trouble::SensorBroken => HeatTrouble::ThermometerBroken,
            Trouble::SensorJump => HeatTrouble::ThermometerJump,
            Trouble::SensorsDiffer => HeatTrouble::ThermometersDiffer,
            Trouble::SensorStuck => HeatTrouble::ThermometerStuck,
            Trouble::EnergyBalance => HeatTrouble::EnergyBalance,
            Trouble::HeatWithoutCommand => HeatTrouble::HeatWithoutCommand,
            Trouble::OverSetPoint => HeatTrouble::OverSetPoint,
            Trouble::RampNotReached => HeatTrouble::RampNotReached,
            Trouble::CoolingTooSlow => HeatTrouble::CoolingTooSlow,
        })
    }
}
