//! Calibration of a rig for relays: the factors that turn terminal volts, output commands and counts into quantities,
//! each with its standard uncertainty.
//!
//! The factors come from the references on the interface board (5.000 V, 400 ohm, 50 mOhm, 1.000 ms) and from
//! reference parts, never from the parts under test. A calibration without reference parts measures no threshold
//! ([`Calibration::overshoots`] is `None`).

use super::coil::relative_per_kelvin;
use super::overshoot::OvershootModel;
use super::recipe::CoilChannels;
use super::threshold::Direction;
use crate::dut::calibration::CalibrationFacts;
use crate::dut::promise::Broken;
use crate::gauge::factor::Named;
use crate::gauge::{Deviation, Factor};
use serde::{Deserialize, Serialize};
use units::{Celsius, Unit, Volt};

/// Temperature at which the sensitivities of reference parts are taken.
pub(super) const ABOUT: Celsius = Celsius(23.0);

/// Reading of an analog input as a linear function of the true terminal voltage.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct InputLine {
    /// Volts read per true volt.
    pub gain: Factor,
    /// Volts read with no signal.
    pub offset_v: Factor,
}

impl InputLine {
    /// Returns the true terminal voltage of a reading.
    pub fn correct(&self, read: Volt) -> Volt {
        Volt((read.0 - self.offset_v.value) / self.gain.value)
    }
}

/// Coil voltage from one of the three supply outputs, as a linear function of the wanted voltage.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct OutputLine {
    /// Volts at the coil per wanted volt.
    pub gain: Factor,
    /// Volts at the coil when 0 V is wanted.
    pub offset_v: Factor,
}

impl OutputLine {
    /// An output without error.
    pub const IDEAL: Self = Self {
        gain: Factor { value: 1.0, u: 0.0 },
        offset_v: Factor { value: 0.0, u: 0.0 },
    };

    /// Returns the voltage to command so that `wanted` reaches the coil.
    pub fn command_for(&self, wanted: Volt) -> Volt {
        Volt((wanted.0 - self.offset_v.value) / self.gain.value)
    }

    /// Returns the voltage at the coil for the command `command`.
    pub fn delivers(&self, command: Volt) -> Volt {
        Volt(self.offset_v.value + self.gain.value * command.0)
    }
}

/// Overshoot of the ramps beyond the quasi-static threshold, found on reference parts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Overshoot {
    /// Indicated minus certified threshold on the fine ramp, volts; positive for operate, negative for release.
    pub fine_v: Factor,
    /// Mean certified threshold of the reference parts, volts. [`Overshoot::fine_v`] contains the gain error of the
    /// supply at this voltage; for another threshold the gain adds uncertainty in proportion to its distance from this
    /// voltage.
    #[serde(default)]
    pub at_v: f64,
    /// Mean of coarse minus fine indication of the reference parts, volts.
    #[serde(default)]
    pub at_coarse_v: f64,
    /// Model of coarse minus fine indication. It places the fine ramp, and gives results where a recipe allows that.
    #[serde(default = "assumed_model")]
    pub coarse: OvershootModel,
    /// True when a coarse ramp alone may give results: enough parts of the lot have taught the model.
    #[serde(default)]
    pub judges: bool,
}

/// Number of parts of a lot that teach the model of the coarse overshoot before it gives results.
const FIRST_PARTS: u32 = 20;

impl Overshoot {
    /// Returns this overshoot with the model taught by all parts, or with that of the lot once [`FIRST_PARTS`] have
    /// taught it.
    ///
    /// The thresholds of reference parts lie too far apart for a linear model: one taught by these places ramps but
    /// gives no results.
    pub fn taught(self, by_all: OvershootModel, by_lot: OvershootModel) -> Self {
        let judges = by_lot.parts() >= FIRST_PARTS;
        let coarse = if judges { by_lot } else { by_all };
        Self {
            coarse,
            judges,
            ..self
        }
    }

    /// Returns the fine overshoot of this part beyond that of the reference parts, volts (1 sd).
    ///
    /// On a rising ramp the armature causes the delay at both rates, so the fine overshoot grows in proportion to the
    /// coarse one. On a falling ramp the decay of the flux causes it: the coarse overshoot then does not predict the
    /// fine one and only adds uncertainty. Without a coarse ramp the overshoot of the reference parts counts as
    /// uncertainty.
    pub fn own_v(&self, coarse_minus_fine_v: f64, direction: Direction) -> Factor {
        let further = self.fine_v.value * (coarse_minus_fine_v / self.at_coarse_v - 1.0);
        match direction {
            _ if !further.is_finite() => Factor::new(0.0, self.fine_v.value.abs()),
            Direction::Rising => Factor::new(further, further.abs()),
            Direction::Falling => Factor::new(0.0, further.abs()),
        }
    }
}

/// Returns the model for a stored calibration that has none.
fn assumed_model() -> OvershootModel {
    OvershootModel::guess(0.0, 1.0)
}

/// Returns the range factor of a calibration stored by a version of the program that had no supply ranges.
fn only_range() -> f64 {
    1.0
}

/// Overshoots of the ramps in both directions.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Overshoots {
    /// Rising ramp to NO make.
    pub operate: Overshoot,
    /// Falling ramp to NO break.
    pub release: Overshoot,
}

/// What reference parts show about the temperature of parts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Temperature {
    /// How far the temperature of a part lies from the mean of the reference parts, both taken relative to the magazine
    /// track, kelvin.
    pub part_k: Deviation,
    /// Certified over found coil resistance at the reference temperature. It contains the error of the thermometer, of
    /// the reference resistor and the mean heating of the coil.
    pub coil: Factor,
    /// Standard deviation of the mean temperature of the reference parts from the track, kelvin: another day finds other
    /// factors of the same rig. 0 in calibrations of earlier versions.
    #[serde(default)]
    pub mean_k: f64,
}

/// All factors of a rig with their dates, as the history stores them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    /// Time of the measurement, microseconds since 1970 UTC.
    pub made_at_us: i64,
    /// Expiry, microseconds since 1970 UTC.
    pub due_at_us: i64,
    /// True on a simulated rig; a real rig refuses such a calibration.
    pub simulated: bool,
    /// Nominal coil voltage of the reference parts; the overshoot is valid for this voltage only.
    pub nominal_v: f64,
    /// Linear function of the converter inputs that read the coil.
    pub coil_input: InputLine,
    /// Ohms per unit of (voltage reading / current reading) on the fine channels.
    pub ohm_fine: Factor,
    /// [`Calibration::ohm_fine`] on the wide current channel, for coils beyond the range of the fine one.
    pub ohm_wide: Factor,
    /// [`Calibration::ohm_fine`] on the high current channel; `None` on a rig without one.
    #[serde(default)]
    pub ohm_high: Option<Factor>,
    /// Factor of the supply range in which the calibration was made; the lines of the outputs and of the coil voltage
    /// are valid in no other range.
    #[serde(default = "only_range")]
    pub range_factor: f64,
    /// Milliohms per volt of contact drop at the terminal, where the drop is half the difference between both
    /// polarities.
    pub contact_mohm_per_v: Factor,
    /// Delays of the gates of counters 0 and 1, microseconds; each gate counts too long by its delay.
    pub gate_delay_us: [Factor; 2],
    /// Supply output for levels.
    pub level: OutputLine,
    /// Supply output for the coarse ramp.
    pub coarse: OutputLine,
    /// Supply output for the fine ramp.
    pub fine: OutputLine,
    /// Slope of the coarse ramp at the coil, volts per second.
    pub coarse_v_per_s: Factor,
    /// Slope of the fine ramp at the coil, volts per second.
    pub fine_v_per_s: Factor,
    /// Overshoot of the ramps; `None` before the reference parts are measured.
    #[serde(rename = "lags")]
    pub overshoots: Option<Overshoots>,
    /// Temperature of the parts; `None` before the reference parts are measured.
    #[serde(default)]
    pub temperature: Option<Temperature>,
    /// Resistance of the coil's two force contacts while the reference parts were measured, ohm; 0 when unknown. The
    /// overshoot contains its effect.
    #[serde(default)]
    pub probe_contact_ohm: f64,
    /// Accuracies promised in `rig.toml` that the calibration has disproved.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub broken: Vec<Broken>,
}

impl Calibration {
    /// Returns ideal factors of infinite uncertainty, for the measurement of the references.
    pub fn unknown(nominal_v: f64, range_factor: f64) -> Self {
        let unknown = Factor::new(1.0, f64::INFINITY);
        Self {
            made_at_us: 0,
            due_at_us: 0,
            simulated: false,
            nominal_v,
            coil_input: InputLine {
                gain: unknown,
                offset_v: Factor::new(0.0, f64::INFINITY),
            },
            ohm_fine: unknown,
            ohm_wide: unknown,
            ohm_high: None,
            range_factor,
            contact_mohm_per_v: unknown,
            gate_delay_us: [Factor::new(0.0, f64::INFINITY); 2],
            level: OutputLine::IDEAL,
            coarse: OutputLine::IDEAL,
            fine: OutputLine::IDEAL,
            coarse_v_per_s: unknown,
            fine_v_per_s: unknown,
            overshoots: None,
            temperature: None,
            probe_contact_ohm: 0.0,
            broken: Vec::new(),
        }
    }

    /// Returns dates, nominal voltage and factors.
    pub fn facts(&self) -> CalibrationFacts {
        CalibrationFacts {
            made_at_us: self.made_at_us,
            due_at_us: self.due_at_us,
            is_simulated: self.simulated,
            nominal_v: self.nominal_v,
            range_factor: self.range_factor,
            is_complete: self.overshoots.is_some(),
            factors: self.factors(),
        }
    }

    /// Returns ohms per unit of (voltage reading / current reading) for these channels, corrected by the reference
    /// parts once these are measured.
    pub fn ohm(&self, channels: CoilChannels) -> Factor {
        let by_resistor = match channels {
            CoilChannels::Fine => self.ohm_fine,
            CoilChannels::CoarseCurrent => self.ohm_wide,
            CoilChannels::HighCurrent => self.ohm_high.unwrap_or(Factor::new(1.0, f64::INFINITY)),
        };
        self.temperature.map_or(by_resistor, |found| {
            let ohm = by_resistor.value;
            Factor::new(ohm * found.coil.value, ohm * found.coil.u)
        })
    }

    /// Returns every measured factor, as uncertain as it is for another day. The slope of the coarse ramp is absent,
    /// because it is the maker's and not measured.
    fn factors(&self) -> Vec<Named> {
        let named = |name, unit, factor| Named { name, unit, factor };
        let mut all = vec![
            named("coil_input_gain", Unit::One, self.coil_input.gain),
            named("coil_input_offset", Unit::Volt, self.coil_input.offset_v),
            named("coil_fine", Unit::Ohm, self.ohm_fine),
            named("coil_wide", Unit::Ohm, self.ohm_wide),
            named("contact", Unit::MilliohmPerVolt, self.contact_mohm_per_v),
            named("gate_delay_0", Unit::Microsecond, self.gate_delay_us[0]),
            named("gate_delay_1", Unit::Microsecond, self.gate_delay_us[1]),
            named("level_gain", Unit::One, self.level.gain),
            named("level_offset", Unit::Volt, self.level.offset_v),
            named("coarse_gain", Unit::One, self.coarse.gain),
            named("fine_gain", Unit::One, self.fine.gain),
            named("fine_slope", Unit::VoltPerSecond, self.fine_v_per_s),
        ];
        all.extend(self.ohm_high.map(|it| named("coil_high", Unit::Ohm, it)));
        let mean_k = self.temperature.map_or(0.0, |it| it.mean_k);
        if let Some(Temperature { coil, .. }) = self.temperature {
            let factor = on_any_day(coil, coil.value, mean_k);
            all.push(named("coil_correction", Unit::One, factor));
        }
        if let Some(Overshoots { operate, release }) = &self.overshoots {
            let lag = |it: &Overshoot| on_any_day(it.fine_v, it.at_v, mean_k);
            all.push(named("operate_lag", Unit::Volt, lag(operate)));
            all.push(named("release_lag", Unit::Volt, lag(release)));
        }
        all
    }
}

/// Returns a factor that changes by `scale` times the relative change of copper, with the uncertainty that the mean
/// temperature of the reference parts, [`Temperature::mean_k`], adds to it from day to day.
fn on_any_day(factor: Factor, scale: f64, mean_k: f64) -> Factor {
    let moves = scale * relative_per_kelvin(ABOUT) * mean_k;
    Factor::new(factor.value, factor.u.hypot(moves))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_temperature_of_a_day_moves_factors_of_reference_parts() {
        let coil = on_any_day(Factor::new(0.999, 0.0), 0.999, 0.1);
        assert!((coil.u / 0.000_388 - 1.0).abs() < 0.01, "{}", coil.u);
        let lag = on_any_day(Factor::new(0.038, 0.001), 7.9, 0.1);
        assert!(
            (lag.u - 0.001_f64.hypot(0.003_07)).abs() < 2e-5,
            "{}",
            lag.u
        );
    }

    #[test]
    fn asking_for_a_voltage_delivers_it() {
        let line = OutputLine {
            gain: Factor::new(1.0004, 0.0),
            offset_v: Factor::new(-0.0021, 0.0),
        };
        let command = line.command_for(Volt(7.9));
        assert!((line.delivers(command).0 - 7.9).abs() < 1e-12);
    }

    #[test]
    fn the_coarse_ramp_corrects_a_parts_fine_overshoot() {
        let overshoot = Overshoot {
            fine_v: Factor::new(0.028, 0.0),
            at_v: 7.88,
            at_coarse_v: 0.84,
            coarse: OvershootModel::guess(0.84, 1.0),
            judges: false,
        };
        let rising = |coarse_v| overshoot.own_v(coarse_v, Direction::Rising);
        assert_eq!(rising(0.84), Factor::new(0.0, 0.0));
        let late = rising(0.90);
        assert!((late.value - 0.002).abs() < 1e-12 && late.u == late.value);
        assert_eq!(rising(f64::NAN), Factor::new(0.0, 0.028));
        let falling = overshoot.own_v(0.90, Direction::Falling);
        assert_eq!((falling.value, falling.u), (0.0, late.u));
        let without_coarse = Overshoot {
            at_coarse_v: 0.0,
            ..overshoot
        };
        assert_eq!(without_coarse.own_v(0.90, Direction::Rising).u, 0.028);
    }
}
