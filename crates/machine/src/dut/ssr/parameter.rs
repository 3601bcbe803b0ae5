//! Characteristics of a solid-state relay, as data.

use super::bins;
use crate::dut::characteristic::{
    AcceptedError, Characteristic, Definition, ErrorUnit, KindCharacteristic,
};
use crate::gauge::repetition::MeanOf;
use crate::rig::bin::Bin;
use units::Unit;

/// Characteristic of a solid-state relay.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Parameter {
    /// Control voltage at which the output begins to conduct.
    TurnOnVoltage,
    /// Control voltage at which the output ceases to conduct.
    TurnOffVoltage,
    /// Current of the control input at the nominal control voltage.
    InputCurrent,
    /// Current of the reversed control input.
    ReverseCurrent,
    /// Time from the control edge to 90 % of the load voltage.
    TurnOnTime,
    /// Time from the control edge to 10 % of the load voltage.
    TurnOffTime,
    /// Drop of the conducting output at its rated current; for an AC part at the peak of that current.
    Drop,
    /// Root mean square of the drop of an AC part at its rated current.
    DropRms,
    /// Resistance of the conducting output.
    OnResistance,
    /// Current of the blocked output at its rated voltage, before the output has conducted.
    LeakageCold,
    /// Current of the blocked output at its rated voltage, after the output has conducted.
    LeakageHot,
    /// Part of the leakage in phase with the voltage.
    LeakageResistive,
    /// Part of the leakage a quarter of a period ahead of the voltage.
    LeakageCapacitive,
    /// Voltage at the output of an AC part at the instant at which it turns on.
    ZeroCross,
    /// Greatest voltage at the output at the start of later half cycles.
    Retrigger,
    /// Mean of the voltage at the conducting output over whole cycles.
    DcOffset,
    /// Rms of the load voltage of the conducting output without its fundamental and its mean.
    Distortion,
    /// Difference of the charges of both half cycles, as a share of their sum.
    HalfWave,
    /// Rise of the drop from 10 ms to 200 ms after the current has begun.
    Drift,
}

impl Parameter {
    /// Every characteristic, in the order of reports.
    pub const ALL: [Self; 19] = [
        Self::TurnOnVoltage,
        Self::TurnOffVoltage,
        Self::InputCurrent,
        Self::ReverseCurrent,
        Self::TurnOnTime,
        Self::TurnOffTime,
        Self::Drop,
        Self::DropRms,
        Self::OnResistance,
        Self::LeakageCold,
        Self::LeakageHot,
        Self::LeakageResistive,
        Self::LeakageCapacitive,
        Self::ZeroCross,
        Self::Retrigger,
        Self::DcOffset,
        Self::Distortion,
        Self::HalfWave,
        Self::Drift,
    ];
}

impl Parameter {
    /// Returns true for a characteristic of outputs for a DC load.
    pub const fn is_of_dc(self) -> bool {
        match self {
            Self::TurnOnVoltage
            | Self::TurnOffVoltage
            | Self::InputCurrent
            | Self::ReverseCurrent
            | Self::TurnOnTime
            | Self::TurnOffTime
            | Self::Drop
            | Self::OnResistance
            | Self::LeakageCold
            | Self::LeakageHot
            | Self::Drift => true,
            Self::DropRms
            | Self::LeakageResistive
            | Self::LeakageCapacitive
            | Self::ZeroCross
            | Self::Retrigger
            | Self::DcOffset
            | Self::Distortion
            | Self::HalfWave => false,
        }
    }

    /// Returns true for a characteristic of outputs for an AC load. Those with random turn-on have no zero-cross voltage.
    pub const fn is_of_ac(self, zero_cross: bool) -> bool {
        match self {
            Self::OnResistance => false,
            Self::ZeroCross => zero_cross,
            Self::TurnOnVoltage
            | Self::TurnOffVoltage
            | Self::InputCurrent
            | Self::ReverseCurrent
            | Self::TurnOnTime
            | Self::TurnOffTime
            | Self::Drop
            | Self::DropRms
            | Self::LeakageCold
            | Self::LeakageHot
            | Self::LeakageResistive
            | Self::LeakageCapacitive
            | Self::Retrigger
            | Self::DcOffset
            | Self::Distortion
            | Self::HalfWave
            | Self::Drift => true,
        }
    }
}

impl Parameter {
    /// Returns true for a characteristic that a recipe may measure on a sample of the lot instead of on every part.
    pub const fn is_sampled(self) -> bool {
        matches!(self, Self::DcOffset | Self::Distortion)
    }
}

impl KindCharacteristic for Parameter {
    fn definition(&self) -> &'static Definition {
        &DEFINITIONS[*self as usize]
    }

    fn accepted_error(&self, _rated_v: Option<f64>) -> Option<AcceptedError> {
        let (unit, rms) = match self {
            Self::TurnOnVoltage | Self::TurnOffVoltage => (ErrorUnit::Millivolt, 10.0),
            Self::TurnOnTime | Self::TurnOffTime => (ErrorUnit::Own, 10.0),
            Self::Drop | Self::DropRms => (ErrorUnit::Millivolt, 3.0),
            Self::LeakageResistive => (ErrorUnit::Own, 3.0),
            Self::ZeroCross => (ErrorUnit::Own, 0.5),
            Self::OnResistance => (ErrorUnit::Own, 1.0),
            // 20 nA and 1 %.
            Self::LeakageCold | Self::LeakageHot => {
                return Some(AcceptedError {
                    share: 0.01,
                    ..AcceptedError::of(ErrorUnit::Own, 0.02)
                });
            }
            Self::InputCurrent
            | Self::ReverseCurrent
            | Self::LeakageCapacitive
            | Self::Retrigger
            | Self::DcOffset
            | Self::Distortion
            | Self::HalfWave
            | Self::Drift => return None,
        };
        Some(AcceptedError::of(unit, rms))
    }
}

static DEFINITIONS: [Definition; Parameter::ALL.len()] = [
    part("v_on_v", Unit::Volt, bins::INPUT),
    part("v_off_v", Unit::Volt, bins::INPUT),
    part("i_in_ma", Unit::Milliampere, bins::INPUT),
    part("i_rev_ua", Unit::Microampere, bins::INPUT),
    operation("t_on_us"),
    operation("t_off_us"),
    part("v_drop_v", Unit::Volt, bins::OUTPUT),
    part("v_drop_rms_v", Unit::Volt, bins::OUTPUT),
    part("r_on_mohm", Unit::Milliohm, bins::OUTPUT),
    part("i_leak_ua", Unit::Microampere, bins::LEAKAGE),
    part("i_leak_hot_ua", Unit::Microampere, bins::LEAKAGE),
    part("i_leak_resistive_ua", Unit::Microampere, bins::LEAKAGE),
    part("i_leak_capacitive_ua", Unit::Microampere, bins::LEAKAGE),
    part("v_zc_v", Unit::Volt, bins::OUTPUT),
    part("v_retrig_v", Unit::Volt, bins::OUTPUT),
    part("dc_offset_mv", Unit::Millivolt, bins::OUTPUT),
    part("wave_dist_mv", Unit::Millivolt, bins::OUTPUT),
    part("halfwave_pct", Unit::Percent, bins::OUTPUT),
    part("drift_mv", Unit::Millivolt, bins::OUTPUT),
];

const fn part(key: &'static str, unit: Unit, bin: Bin) -> Definition {
    Definition {
        key,
        unit,
        mean_of: MeanOf::Part,
        bin,
    }
}

const fn operation(key: &'static str) -> Definition {
    Definition {
        mean_of: MeanOf::Operation,
        ..part(key, Unit::Microsecond, bins::TIME)
    }
}

impl From<Parameter> for Characteristic {
    fn from(parameter: Parameter) -> Self {
        Self::Ssr(parameter)
    }
}
