//! Placement of fine ramps, for operate and release: around an estimate, and anew after a ramp that has missed the
//! event.

use super::Context;
use super::indication::coarse_reading;
use super::search::parameter;
use super::state::TestState;
use crate::dut::em_relay::calibration::Overshoot;
use crate::dut::em_relay::coil::to_reference;
use crate::dut::em_relay::overshoot::CoarseResults;
use crate::dut::em_relay::readings::Readings;
use crate::dut::em_relay::scale::Scale;
use crate::dut::em_relay::threshold::Direction;
use units::{Celsius, Volt};

// Voltages are those of a 12 V coil in the range of factor 1; see `scale`.

/// Step of the level between ARM and ramp. The fine ramp alone would take 33 ms to move by
/// [`WINDOW`](crate::dut::em_relay::threshold::WINDOW), which opens the window; this step leaves it only 5 mV, for the
/// tolerance of the comparator. Flux and armature settle after the step.
pub(super) const JUMP: Volt = Volt(0.045);
/// Distance of a falling ramp before the interval that it searches: the flux of a sealed armature follows the ramp with
/// a delay of 6 to 9 ms and still decays from the seal.
const RUN_DOWN: Volt = Volt(0.085);
/// Distance of a falling ramp after which only 1 mV of the seal's effect remains: a later event belongs to the ramp.
pub(super) const SETTLED_DOWN: Volt = Volt(0.068);
/// Length of a rising and of a falling ramp beyond the far end of its interval, for the scatter of the overshoot. A
/// rising ramp ends at the event, so that its length costs no time; a falling one needs a fine output as high as it is
/// long.
const FAR_MARGINS: [Volt; 2] = [Volt(0.2), Volt(0.015)];
/// Half width of an interval, in standard deviations of its estimate. One ramp in some thousands misses, which
/// costs a second ramp of 0.3 s. Three deviations would save every part 5 ms, but make one part in four hundred late.
const COVERAGE: f64 = 3.5;
/// Largest standard deviation that widens an interval. Each further 10 mV would cost every such part 8 ms, whereas a
/// miss (one part in some dozens) costs 0.3 s.
const WIDEST_SD: Volt = Volt(0.02);
/// Widest half width that a ramp searches; a search by halves is quicker beyond it.
const WIDEST: Volt = Volt(0.2);
/// Standard uncertainty of the assumed overshoot of a fine ramp, volts.
const FINE_GUESS_SD: Volt = Volt(0.020);
/// Standard deviation of the difference between two operations, volts. `TWO_TEMPERATURES` is the standard deviation
/// that a temperature difference of 0.25 K between reference parts causes, as a share of the threshold.
const TWO_OPERATIONS: Volt = Volt(0.004);
const TWO_TEMPERATURES: f64 = 0.001;
/// Width of the next interval, as a multiple of that of the missed one: nine standard deviations to each side, which stay
/// below [`WIDEST`].
const WIDER: f64 = 2.6;

/// Interval of indicated voltage that a fine ramp searches for the contact event.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Expected {
    /// Most likely indicated voltage.
    pub centre: Volt,
    /// Half width of the interval.
    pub half_width: Volt,
}

/// Start and length of a fine ramp.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placed {
    /// Supply voltage before the ramp.
    pub start: Volt,
    /// Length of the ramp, positive.
    pub span: Volt,
}

impl Expected {
    /// Returns the interval around an estimate with standard deviation `sd_v`.
    pub fn new(centre: Volt, sd_v: f64) -> Self {
        Self {
            centre,
            half_width: Volt(COVERAGE * sd_v),
        }
    }

    /// Returns the interval that a coarse ramp and the overshoot model predict.
    pub fn after(coarse: &CoarseResults, overshoot: &Overshoot, scale: Scale) -> Self {
        let predicted = overshoot.coarse.of(coarse);
        let sd_v = predicted.u_v.min(scale.of_range(WIDEST_SD).0);
        Self::new(coarse.indicated - Volt(predicted.volts), sd_v)
    }

    /// Returns the interval that the reference part's certificate predicts while the overshoot is learned, else `None`.
    pub fn certified(context: &Context, track: Celsius, direction: Direction) -> Option<Self> {
        let (part, scale) = (context.teaching.as_ref()?, context.scale());
        let overshoot = context.overshoot(direction);
        let at_part =
            part.threshold(direction).value / to_reference(track, context.reference_temperature());
        let sd_v = if overshoot.coarse.parts() == 0 {
            scale.of_coil(FINE_GUESS_SD).0
        } else {
            let operations = scale.of_coil(TWO_OPERATIONS);
            operations.0.hypot(TWO_TEMPERATURES * at_part)
        };
        Some(Self::new(Volt(at_part + overshoot.fine_v.value), sd_v))
    }

    /// Returns the rising ramp over this interval after a run-up.
    pub fn rising(&self, run_up: Volt, scale: Scale) -> Placed {
        self.placed(Direction::Rising, run_up, scale)
    }

    /// Returns the falling ramp over this interval.
    pub fn falling(&self, scale: Scale) -> Placed {
        self.placed(Direction::Falling, scale.of_range(RUN_DOWN), scale)
    }

    fn placed(&self, direction: Direction, run: Volt, scale: Scale) -> Placed {
        let lead = scale.of_range(JUMP) + run;
        let [rising, falling] = FAR_MARGINS;
        let beyond = match direction {
            Direction::Rising => rising,
            Direction::Falling => falling,
        };
        Placed {
            start: self.centre - (self.half_width + lead) * direction.sign(),
            span: lead + self.half_width * 2.0 + scale.of_range(beyond),
        }
    }

    /// Returns an interval of the same width around `end`, at which the ramp stopped before the event: the gate time
    /// after the stop shows a wait, not volts.
    pub fn around(&self, end: Volt) -> Self {
        Self {
            centre: end,
            half_width: self.half_width,
        }
    }

    /// Returns the interval after a miss, [`WIDER`] times as wide. When the contact has not changed, the interval extends
    /// beyond the far end. When it changed too early, the far end stays: the event lies before the near end, or the
    /// approach came too near to it.
    pub fn next(&self, direction: Direction, changed_early: bool) -> Self {
        let further = if changed_early {
            1.0 - WIDER
        } else {
            1.0 + WIDER
        };
        Self {
            centre: self.centre + self.half_width * (further * direction.sign()),
            half_width: self.half_width * WIDER,
        }
    }

    /// Returns true when a search by halves is quicker than a ramp.
    pub fn is_wide(&self, scale: Scale) -> bool {
        self.half_width > scale.of_range(WIDEST)
    }
}

/// Returns the end of a ramp from `start` when the indicated voltage `seen` lies beyond that end.
pub(super) fn stopped_at(start: Volt, span: Volt, seen: Volt) -> Option<Volt> {
    ((seen - start).abs() > span).then_some(start + Volt(span.0.copysign((seen - start).0)))
}

/// Places the fine ramp after a coarse one; records the coarse result if the strategy accepts it as a result. Returns
/// true when the part needs a fine ramp that the recipe has not planned.
pub(super) fn after_coarse(
    context: &Context,
    readings: &Readings,
    state: &mut TestState,
    (seen, direction): (CoarseResults, Direction),
) -> bool {
    let Some(part) = state.record.own.track else {
        return false;
    };
    let (overshoot, parameter) = (context.overshoot(direction), parameter(direction));
    let certified = Expected::certified(context, part, direction);
    let expected = certified.unwrap_or_else(|| Expected::after(&seen, &overshoot, context.scale()));
    state.plan.expect(direction, expected);
    let strategy = context.strategy(parameter);
    match coarse_reading(context, (seen, overshoot), part, direction) {
        Some(reading) if strategy.trusts_coarse() => {
            let gates = readings.gates.iter().flatten();
            state.record.found(parameter, reading, gates);
            false
        }
        Some(_) | None => !strategy.always_fine(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dut::em_relay::threshold::WINDOW;

    #[test]
    fn the_window_is_open_before_the_earliest_expected_event() {
        let expected = Expected::new(Volt(7.9), 0.01);
        let ramp = expected.rising(Volt(0.060), Scale::new(12.0, 1.0));
        assert!(ramp.start.0 + WINDOW.0 < 7.9 - 0.034);
        assert!(ramp.start.0 + ramp.span.0 > 7.9 + 0.034);
        let falling = expected.falling(Scale::new(12.0, 1.0));
        assert!(falling.start.0 - WINDOW.0 > 7.9 + 0.034);
    }

    #[test]
    fn an_event_beyond_the_ramp_yields_its_end() {
        assert_eq!(
            stopped_at(Volt(7.8), Volt(0.1), Volt(7.95)),
            Some(Volt(7.8 + 0.1))
        );
        assert_eq!(
            stopped_at(Volt(2.5), Volt(0.1), Volt(2.35)),
            Some(Volt(2.5 - 0.1))
        );
        assert_eq!(stopped_at(Volt(7.8), Volt(0.1), Volt(7.89)), None);
    }

    #[test]
    fn after_no_event_the_next_interval_adjoins() {
        let beyond = NARROW.next(Direction::Rising, false);
        assert!((beyond.centre.0 - beyond.half_width.0 - 7.93).abs() < 1e-12);
        let below = NARROW.next(Direction::Falling, false);
        assert!((below.centre.0 + below.half_width.0 - 7.87).abs() < 1e-12);
    }

    #[test]
    fn an_early_event_extends_the_interval_towards_the_start() {
        let again = NARROW.next(Direction::Rising, true);
        assert!((again.centre.0 + again.half_width.0 - 7.93).abs() < 1e-12);
        assert!((again.centre.0 - again.half_width.0 - 7.774).abs() < 1e-12);
        let again = NARROW.next(Direction::Falling, true);
        assert!((again.centre.0 - again.half_width.0 - 7.87).abs() < 1e-12);
    }

    const NARROW: Expected = Expected {
        centre: Volt(7.9),
        half_width: Volt(0.03),
    };
}
