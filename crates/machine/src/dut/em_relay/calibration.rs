//! What this rig's instruments were found to do: the factors that turn terminal volts, output
//! commands and counts into quantities, each with its standard uncertainty.
//!
//! The factors come from the references on the interface board (5.000 V, 400 ohm, 50 mOhm, 1.000 ms)
//! and from golden parts, never from the specimens they are later used on. A calibration without
//! golden parts has no lag corrections and measures no threshold ([`Calibration::overshoots`] is `None`).

use super::overshoot::OvershootModel;
use super::threshold::Direction;
use crate::gauge::Factor;
use crate::gauge::factor::Named;
use serde::{Deserialize, Serialize};
use units::{Unit, Volt};

/// Reading of an analog input as a straight line of the true terminal voltage.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct InputLine {
    /// Volts read per true volt.
    pub gain: Factor,
    /// Volts read with no signal.
    pub offset_v: Factor,
}

impl InputLine {
    /// Terminal voltage behind a reading.
    pub fn correct(&self, read: Volt) -> Volt {
        Volt((read.0 - self.offset_v.value) / self.gain.value)
    }
}

/// Coil voltage that one of the three supply outputs adds, as a straight line of the wanted voltage.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct OutputLine {
    /// Volts at the coil per wanted volt.
    pub gain: Factor,
    /// Volts at the coil when 0 V is wanted.
    pub offset_v: Factor,
}

impl OutputLine {
    /// An output that does exactly what is asked.
    pub const IDEAL: Self = Self {
        gain: Factor { value: 1.0, u: 0.0 },
        offset_v: Factor { value: 0.0, u: 0.0 },
    };

    /// What must be asked of the module so that the coil gets `wanted`.
    pub fn ask_for(&self, wanted: Volt) -> Volt {
        Volt((wanted.0 - self.offset_v.value) / self.gain.value)
    }

    /// What the coil gets when `asked` is asked of the module.
    pub fn delivers(&self, asked: Volt) -> Volt {
        Volt(self.offset_v.value + self.gain.value * asked.0)
    }
}

/// How far a ramp overshoots the quasi-static threshold, found on golden parts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Overshoot {
    /// Indicated minus certified threshold on the fine ramp, volts; positive for operate, negative for release.
    pub fine_v: Factor,
    /// Mean certified threshold of those parts, volts: a gain error of the supply was in [`Overshoot::fine_v`] there,
    /// and only away from it is left over.
    #[serde(default)]
    pub at_v: f64,
    /// Mean of coarse minus fine indication of those parts, volts.
    #[serde(default)]
    pub at_coarse_v: f64,
    /// Coarse minus fine indication: places the fine ramp, and gives results where a recipe trusts it.
    #[serde(default = "untaught")]
    pub coarse: OvershootModel,
    /// That law was taught by parts of the lot, enough of them to judge others like them.
    #[serde(default)]
    pub judges: bool,
}

/// Parts of a lot that teach the coarse lag before it gives results.
const FIRST_PARTS: u32 = 20;

impl Overshoot {
    /// With what golden parts and lot have taught so far, and what the lot alone has. Golden parts are chosen to lie far
    /// apart, where the line bends and their times do not go with their thresholds: they place ramps, and judge nothing
    /// once the lot has taught enough.
    pub fn taught(self, by_all: OvershootModel, by_lot: OvershootModel) -> Self {
        let judges = by_lot.parts() >= FIRST_PARTS;
        let coarse = if judges { by_lot } else { by_all };
        Self {
            coarse,
            judges,
            ..self
        }
    }

    /// How much further than on the golden parts the fine ramp overshoots on a part, volts, and how sure that is (1 sd).
    ///
    /// A rising ramp waits for the armature at both rates: of a part that overshoots more on the coarse one the fine one
    /// overshoots more in proportion. Of sound parts that leaves a fifth of the difference, of a dragging hinge as much
    /// again. A falling ramp waits for the flux, which does not tell the fine lag of a sound part, only of an odd one.
    /// A part that has shown no coarse ramp may be late by any share of what the golden parts were.
    pub fn own_v(&self, coarse_minus_fine_v: f64, direction: Direction) -> Factor {
        let further = self.fine_v.value * (coarse_minus_fine_v / self.at_coarse_v - 1.0);
        match direction {
            _ if !further.is_finite() => Factor::new(0.0, self.fine_v.value.abs()),
            Direction::Rising => Factor::new(further, further.abs()),
            Direction::Falling => Factor::new(0.0, further.abs()),
        }
    }
}

/// Of a calibration that was stored before the lag was a law.
fn untaught() -> OvershootModel {
    OvershootModel::guess(0.0)
}

/// Lag of both directions.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Overshoots {
    /// Rising ramp to NO make.
    pub operate: Overshoot,
    /// Falling ramp to NO break.
    pub release: Overshoot,
}

/// All factors of a rig, as kept in the history with their date.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    /// When the factors were found, microseconds since 1970 UTC.
    pub made_at_us: i64,
    /// When they may no longer be used.
    pub due_at_us: i64,
    /// Made on a simulated rig: never used on a real one.
    pub simulated: bool,
    /// Coil voltage valid for golden lags: those of a 12 V set say nothing about a 6 V part.
    pub nominal_v: f64,
    /// Converter that reads the coil.
    pub coil_input: InputLine,
    /// Ohms per unit of (voltage reading / current reading) on the fine channels.
    pub ohm_fine: Factor,
    /// The same with the wide current channel, for coils that draw too much for the fine one.
    pub ohm_wide: Factor,
    /// Milliohms per volt of contact drop at the terminal, half the difference of both polarities.
    pub contact_mohm_per_v: Factor,
    /// Added to gate 0 and gate 1 by their counters, microseconds.
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
    /// Ramp lags, once golden parts were run.
    #[serde(rename = "lags")]
    pub overshoots: Option<Overshoots>,
    /// Force contacts of the coil in series when the golden parts taught these lags, which hold it, ohm; 0: not known.
    #[serde(default)]
    pub probe_contact_ohm: f64,
}

impl Calibration {
    /// Ideal factors of unknown quality: good enough to measure the references, no more.
    pub fn unknown(nominal_v: f64) -> Self {
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
            contact_mohm_per_v: unknown,
            gate_delay_us: [Factor::new(0.0, f64::INFINITY); 2],
            level: OutputLine::IDEAL,
            coarse: OutputLine::IDEAL,
            fine: OutputLine::IDEAL,
            coarse_v_per_s: unknown,
            fine_v_per_s: unknown,
            overshoots: None,
            probe_contact_ohm: 0.0,
        }
    }

    /// Every factor that was measured. The slope of the coarse ramp is the maker's and not among them.
    pub fn factors(&self) -> Vec<Named> {
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
        if let Some(overshoots) = &self.overshoots {
            all.push(named("operate_lag", Unit::Volt, overshoots.operate.fine_v));
            all.push(named("release_lag", Unit::Volt, overshoots.release.fine_v));
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn asking_for_a_voltage_delivers_it() {
        let line = OutputLine {
            gain: Factor::new(1.0004, 0.0),
            offset_v: Factor::new(-0.0021, 0.0),
        };
        let asked = line.ask_for(Volt(7.9));
        assert!((line.delivers(asked).0 - 7.9).abs() < 1e-12);
    }

    #[test]
    fn the_fine_lag_of_a_part_is_its_own_as_far_as_the_coarse_ramp_tells() {
        let overshoot = Overshoot {
            fine_v: Factor::new(0.028, 0.0),
            at_v: 7.88,
            at_coarse_v: 0.84,
            coarse: OvershootModel::guess(0.84),
            judges: false,
        };
        let rising = |coarse_v| overshoot.own_v(coarse_v, Direction::Rising);
        assert_eq!(rising(0.84), Factor::new(0.0, 0.0));
        let late = rising(0.90);
        assert!((late.value - 0.002).abs() < 1e-12 && late.u == late.value);
        assert_eq!(rising(f64::NAN), Factor::new(0.0, 0.028));
        let falling = overshoot.own_v(0.90, Direction::Falling);
        assert_eq!((falling.value, falling.u), (0.0, late.u));
        let untaught = Overshoot {
            at_coarse_v: 0.0,
            ..overshoot
        };
        assert_eq!(untaught.own_v(0.90, Direction::Rising).u, 0.028);
    }
}
