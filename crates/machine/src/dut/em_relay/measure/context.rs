//! Context of a test: recipe, calibration, and the accuracies of the instruments.

use crate::dut::Recipe;
use crate::dut::accuracy::{AccuracySettings, LSB_V};
use crate::dut::em_relay::act::Act;
use crate::dut::em_relay::calibration::{Calibration, Overshoot};
use crate::dut::em_relay::coil::ScanUncertainty;
use crate::dut::em_relay::overshoot::OvershootModel;
use crate::dut::em_relay::points::{AnalogIn, Points};
use crate::dut::em_relay::recipe::{CoilChannels, RelayRecipe};
use crate::dut::em_relay::reference_part::interim;
use crate::dut::em_relay::sampling::Polarities;
use crate::dut::em_relay::scale::Scale;
use crate::dut::em_relay::settings::{ReferencePart, ReferenceSettings};
use crate::dut::em_relay::threshold::Direction;
use crate::dut::em_relay::timing::Clock;
use crate::dut::em_relay::{Parameter, Strategy};
use crate::gauge::Deviation;
use crate::instrument::act;
use crate::rig::supply::{RangeMismatch, SupplyRange};
use std::sync::Arc;
use units::{Celsius, Ohm, Span, Volt};

/// Assumed overshoot of a 96 V/s ramp before the first reference part; it only places the first fine ramp. The delay
/// that causes the overshoot is the same in every supply range, so the overshoot is proportional to the rate of the
/// ramp.
const ASSUMED_OPERATE: Volt = Volt(0.85);
const ASSUMED_RELEASE: Volt = Volt(-1.05);

/// Assumed overshoot of a 1.5 V/s ramp, operate and release.
const ASSUMED_FINE: [Volt; 2] = [Volt(0.03), Volt(-0.02)];

/// Recipe, calibration and instrument data of a test.
#[derive(Debug, Clone)]
pub struct Context {
    /// Limits and decision rule.
    pub recipe: Arc<Recipe>,
    /// The recipe's sections for a relay.
    pub relay: Arc<RelayRecipe>,
    /// Factors in force.
    pub calibration: Arc<Calibration>,
    /// The points of the rig.
    pub points: Points,
    /// References on the interface board.
    pub reference: ReferenceSettings,
    /// Accuracies that the makers specify.
    pub accuracy: AccuracySettings,
    /// Nominal rates of the coarse and the fine ramp at the coil, volts per second.
    pub nominal_v_per_s: [f64; 2],
    /// Range of the supply; `None` means factor 1 and no limits.
    pub range: Option<SupplyRange>,
    /// Resistance of the coil's two force contacts, mean over the last parts; `None` before the first part.
    pub probe_contact: Option<Ohm>,
    /// True for a reference check or a first article: every result gets confirmation measurements.
    pub thorough: bool,
    /// The reference part in the nest while the overshoot is being learned; its certificate places the fine ramps.
    pub teaching: Option<ReferencePart>,
}

impl Context {
    /// Returns the time until each of `channels` channels holds a fresh conversion, that is, one begun from now on: one
    /// round, one conversion, and 3 % for the tolerance of the converter's clock.
    pub fn fresh(&self, channels: usize) -> Span {
        Span::seconds(1.03 * (channels + 1) as f64 / self.accuracy.conversions_per_s)
    }

    /// Returns the time of one round of conversions over `channels`.
    pub fn round(&self, channels: usize) -> Span {
        Span::seconds(1.03 * channels as f64 / self.accuracy.conversions_per_s)
    }

    /// Returns the channels of the coil converter for the recipe.
    pub fn coil_channels(&self) -> &'static [AnalogIn] {
        match self.relay.test.coil_channels {
            CoilChannels::Fine => &[AnalogIn::CoilVoltageFine, AnalogIn::CoilCurrentFine],
            CoilChannels::CoarseCurrent => &[AnalogIn::CoilVoltageFine, AnalogIn::CoilCurrent],
            CoilChannels::HighCurrent => &[AnalogIn::CoilVoltageFine, AnalogIn::CoilCurrentHigh],
        }
    }

    /// Translates the acts of a test for this rig.
    pub(super) fn wired(&self, acts: Vec<Act>) -> Vec<act::Act> {
        self.points.wired(acts, self.coil_channels())
    }

    /// Returns the standard uncertainty of one reading at the terminal: noise and resolution.
    pub fn reading_u_v(&self) -> f64 {
        LSB_V * (self.accuracy.ai_noise_lsb.powi(2) + 1.0 / 12.0).sqrt()
    }

    /// Returns the uncertainty terms of a coil scan.
    pub fn scan_uncertainty(&self) -> ScanUncertainty {
        let promised_k = self.accuracy.rtd_k.hypot(self.accuracy.part_minus_track_k);
        // The correction by reference parts already contains the error of the thermometer.
        let found = self.calibration.temperature.map(|it| it.part_k);
        ScanUncertainty {
            reading_v: self.reading_u_v(),
            offset_v: self.calibration.coil_input.offset_v.u,
            temperature_k: found.unwrap_or(Deviation::known(promised_k)),
        }
    }

    /// Returns the temperature of a part relative to the track, kelvin; before the reference parts are measured, the
    /// temperature that `rig.toml` promises.
    pub fn part_k(&self) -> Deviation {
        let found = self.calibration.temperature.map(|it| it.part_k);
        found.unwrap_or(Deviation::known(self.accuracy.part_minus_track_k))
    }

    /// Returns the scatter of a threshold of this part from operation to operation, volts (1 sd).
    pub fn operation_v(&self) -> f64 {
        self.scale().operation_v(&self.accuracy)
    }

    /// Returns the relative standard uncertainty of a threshold that comes from the change of the probe contact since
    /// the reference parts were measured. The test does not correct this change.
    pub fn contact_share(&self) -> f64 {
        let then_ohm = self.calibration.probe_contact_ohm;
        let changed = self.probe_contact.map_or(0.0, |Ohm(now)| now - then_ohm);
        changed.abs() / self.relay.part.nominal_coil_ohm
    }

    /// Returns the clock of the gated counters.
    pub fn clock(&self) -> Clock {
        Clock {
            hz: self.reference.counter_clock_hz,
            tolerance_ppm: self.reference.counter_clock_tolerance_ppm,
        }
    }

    /// Returns the reference temperature of the recipe.
    pub fn reference_temperature(&self) -> Celsius {
        Celsius(self.relay.part.reference_temperature_c)
    }

    /// Returns the strategy for a threshold: `coarse_fine` in a thorough test, before the overshoot is known, and under
    /// `adaptive` until enough parts of the lot have taught the overshoot model; else that of the recipe.
    pub fn strategy(&self, parameter: Parameter) -> Strategy {
        let overshoot = self.overshoot(match parameter == Parameter::ReleaseVoltage {
            true => Direction::Falling,
            false => Direction::Rising,
        });
        let mut each = self.relay.test.strategy.each().into_iter();
        match each.find(|(known, _)| *known == parameter) {
            Some(_) if self.thorough => Strategy::CoarseFine,
            Some((_, Strategy::Adaptive)) if !overshoot.judges => Strategy::CoarseFine,
            Some((_, strategy)) if overshoot.fine_v.u.is_finite() => strategy,
            Some(_) | None => Strategy::CoarseFine,
        }
    }

    /// Returns in which directions the contacts are read. The second NO closure of `alternating` is that of the coarse
    /// ramps: without them each closure is read in both directions.
    pub fn polarities(&self) -> Polarities {
        let thresholds = [Parameter::OperateVoltage, Parameter::ReleaseVoltage];
        let ramps = thresholds.iter().all(|it| self.strategy(*it).ramps());
        match self.relay.test.strategy.contact.polarities {
            Polarities::Alternating if !ramps => Polarities::PlusMinus,
            asked => asked,
        }
    }

    /// Returns true when each closure is read in one direction.
    pub fn alternates(&self) -> bool {
        self.polarities() == Polarities::Alternating
    }

    /// Returns the overshoot of a direction; before any reference part, an assumed overshoot with a wide scatter.
    pub fn overshoot(&self, direction: Direction) -> Overshoot {
        let ((operate, release), [rising, falling]) =
            (self.assumed_models(), self.assumed_fine_v());
        match (direction, self.calibration.overshoots) {
            (Direction::Rising, Some(overshoots)) => overshoots.operate,
            (Direction::Falling, Some(overshoots)) => overshoots.release,
            (Direction::Rising, None) => interim(operate, rising),
            (Direction::Falling, None) => interim(release, falling),
        }
    }

    /// Returns the models of both coarse ramps, operate and release, before any part has taught them.
    pub fn assumed_models(&self) -> (OvershootModel, OvershootModel) {
        let scale = self.scale();
        let model = |guess| OvershootModel::guess(scale.of_range(guess).0, scale.coil());
        (model(ASSUMED_OPERATE), model(ASSUMED_RELEASE))
    }

    /// Returns the assumed overshoot of both fine ramps before the first part, operate and release, volts.
    pub fn assumed_fine_v(&self) -> [f64; 2] {
        ASSUMED_FINE.map(|volts| self.scale().of_range(volts).0)
    }

    /// Returns the scale that adapts the constants of this kind to the coil and the supply range.
    pub fn scale(&self) -> Scale {
        let factor = self.range.as_ref().map_or(1.0, |range| range.factor);
        Scale::new(self.relay.part.nominal_v, factor)
    }

    /// Returns the code of the range to select; `None` on a rig with one range.
    pub fn range_code(&self) -> Option<u8> {
        let range = self.range.as_ref();
        range.filter(|it| it.is_selected()).map(|it| it.code)
    }

    /// Returns how the range that was read back differs from the selected one; `None` when both agree, or when no range
    /// was read.
    pub fn range_mismatch(&self, read_back: Option<u8>) -> Option<RangeMismatch> {
        let (range, selector) = (self.range.as_ref()?, self.points.range.as_ref()?);
        selector.mismatch(range, read_back?)
    }
}
