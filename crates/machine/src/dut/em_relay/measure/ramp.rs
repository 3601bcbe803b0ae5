//! What operate and release share: where a fine ramp is placed, around which estimate, and where it is placed anew when
//! the contact changed before the window opened or not at all.

use super::Context;
use super::indication::coarse_reading;
use super::search::parameter;
use super::state::TestState;
use crate::dut::em_relay::calibration::Overshoot;
use crate::dut::em_relay::coil::to_reference;
use crate::dut::em_relay::overshoot::Shown;
use crate::dut::em_relay::readings::Readings;
use crate::dut::em_relay::threshold::Direction;
use units::{Celsius, Volt};

/// The level jumps by this much between ARM and ramp: the window opens after [`WINDOW_V`], and on the fine
/// ramp alone that would take 33 ms. What is left keeps the comparator's tolerance out of the way. Flux and
/// armature settle after the jump, so that the ramp begins at rest.
pub(super) const JUMP: Volt = Volt(0.045);
/// Way of a falling ramp before the interval that it searches: the flux of a sealed armature follows at 6 to 9 ms and
/// still falls from the seal.
const RUN_DOWN: Volt = Volt(0.085);
/// After so much of it a millivolt is left of the seal: an event there is that of the ramp.
pub(super) const SETTLED_DOWN: Volt = Volt(0.068);
/// Beyond the far end of the estimate, for the overshoot's own scatter.
const FAR_MARGIN: Volt = Volt(0.015);
/// Half width of a placed ramp in standard deviations of its estimate. One in four hundred misses and
/// costs a second ramp of 0.2 s; each further half deviation would cost every part some 7 ms.
const COVERAGE: f64 = 3.0;
/// What is less sure gets no wider ramp than one of this (1 sd): each further 10 mV of half width would cost every such
/// part 7 ms, and a second ramp costs 0.3 s where it is needed, one part in some dozens.
const WIDEST_SD_V: f64 = 0.02;
/// Widest half width of a ramp that is placed anew; beyond it a search by halves is quicker.
const WIDEST: Volt = Volt(0.2);
/// Uncertainty of the guessed overshoot of a fine ramp, volts (1 sd).
const FINE_GUESS_SD_V: f64 = 0.020;
/// Operations of two reference parts, volts, and a quarter of a kelvin between them, as a share of the threshold (1 sd).
const TWO_OPERATIONS_V: f64 = 0.004;
const TWO_TEMPERATURES: f64 = 0.001;
/// Width of the next interval against that of the one that was missed.
const WIDER: f64 = 3.0;

/// Where a contact event is expected on the fine ramp.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Expected {
    /// Most likely indicated voltage.
    pub centre: Volt,
    /// Half width of the interval that is searched.
    pub half_width: Volt,
}

/// A fine ramp: from where, and over how much.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placed {
    /// Supply before the ramp.
    pub start: Volt,
    /// Length of the ramp, positive.
    pub span: Volt,
}

impl Expected {
    /// From an estimate with its standard deviation.
    pub fn new(centre: Volt, sd_v: f64) -> Self {
        Self {
            centre,
            half_width: Volt(COVERAGE * sd_v),
        }
    }

    /// Where a coarse ramp and the model of its overshoot say.
    pub fn after(coarse: &Shown, overshoot: &Overshoot) -> Self {
        let predicted = overshoot.coarse.of(coarse);
        let sd_v = predicted.u_v.min(WIDEST_SD_V);
        Self::new(coarse.indicated - Volt(predicted.volts), sd_v)
    }

    /// Where the certificate of a reference part that teaches the overshoot says; the first of them is to tell the fine one.
    pub fn certified(context: &Context, track: Celsius, direction: Direction) -> Option<Self> {
        let part = context.teaching.as_ref()?;
        let overshoot = context.overshoot(direction);
        let certified = match direction {
            Direction::Rising => part.operate_voltage_v,
            Direction::Falling => part.release_voltage_v,
        };
        let at_part = certified.value / to_reference(track, context.reference_temperature());
        let sd_v = if overshoot.coarse.parts() == 0 {
            FINE_GUESS_SD_V
        } else {
            TWO_OPERATIONS_V.hypot(TWO_TEMPERATURES * at_part)
        };
        Some(Self::new(Volt(at_part + overshoot.fine_v.value), sd_v))
    }

    /// The rising ramp that searches this interval after a run-up.
    pub fn rising(&self, run_up: Volt) -> Placed {
        self.placed(Direction::Rising, run_up)
    }

    /// The falling ramp that does.
    pub fn falling(&self) -> Placed {
        self.placed(Direction::Falling, RUN_DOWN)
    }

    fn placed(&self, direction: Direction, run: Volt) -> Placed {
        let lead = JUMP + run;
        Placed {
            start: self.centre - (self.half_width + lead) * direction.sign(),
            span: lead + self.half_width * 2.0 + FAR_MARGIN,
        }
    }

    /// The interval to search when the event came only after the ramp had stopped at `end`: the same
    /// width, around the end. What the counter then shows is time at rest, not volts.
    pub fn around(&self, end: Volt) -> Self {
        Self {
            centre: end,
            half_width: self.half_width,
        }
    }

    /// The interval to search next, three times as wide: what misses by more than expected may miss by much. Beyond the
    /// far end when nothing happened. When the contact had already changed the far end stays: either the event lies
    /// before the near end, or the approach has brought the armature too near.
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

    /// A ramp over it would take longer than a search by halves.
    pub fn is_wide(&self) -> bool {
        self.half_width > WIDEST
    }
}

/// Where a ramp from `start` stops, when the indicated voltage lies beyond it.
pub(super) fn stopped_at(start: Volt, span: Volt, seen: Volt) -> Option<Volt> {
    ((seen - start).abs() > span).then_some(start + Volt(span.0.copysign((seen - start).0)))
}

/// Draws what follows from a coarse ramp: where the fine one looks, and the result where the recipe trusts this one.
/// True if a fine one has to be put in that the recipe did not plan.
pub(super) fn after_coarse(
    context: &Context,
    readings: &Readings,
    state: &mut TestState,
    (seen, direction): (Shown, Direction),
) -> bool {
    let Some(part) = state.record.own.track else {
        return false;
    };
    let (overshoot, parameter) = (context.overshoot(direction), parameter(direction));
    let certified = Expected::certified(context, part, direction);
    let expected = certified.unwrap_or_else(|| Expected::after(&seen, &overshoot));
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
    use crate::dut::em_relay::threshold::WINDOW_V;

    #[test]
    fn the_window_is_open_before_the_earliest_expected_event() {
        let expected = Expected::new(Volt(7.9), 0.01);
        let ramp = expected.rising(Volt(0.060));
        assert!(ramp.start.0 + WINDOW_V.0 < 7.9 - 0.025);
        assert!(ramp.start.0 + ramp.span.0 > 7.9 + 0.025);
        let falling = expected.falling();
        assert!(falling.start.0 - WINDOW_V.0 > 7.9 + 0.025);
    }

    #[test]
    fn an_event_after_the_end_of_the_ramp_tells_time_not_volts() {
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
    fn after_nothing_the_next_interval_begins_where_the_last_ended() {
        let beyond = NARROW.next(Direction::Rising, false);
        assert!((beyond.centre.0 - beyond.half_width.0 - 7.93).abs() < 1e-12);
        let below = NARROW.next(Direction::Falling, false);
        assert!((below.centre.0 + below.half_width.0 - 7.87).abs() < 1e-12);
    }

    #[test]
    fn after_an_early_event_the_next_interval_begins_earlier_and_ends_where_the_last_did() {
        let again = NARROW.next(Direction::Rising, true);
        assert!((again.centre.0 + again.half_width.0 - 7.93).abs() < 1e-12);
        assert!((again.centre.0 - again.half_width.0 - 7.75).abs() < 1e-12);
        let again = NARROW.next(Direction::Falling, true);
        assert!((again.centre.0 - again.half_width.0 - 7.87).abs() < 1e-12);
    }

    const NARROW: Expected = Expected {
        centre: Volt(7.9),
        half_width: Volt(0.03),
    };
}
