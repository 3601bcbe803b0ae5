//! Searches for a threshold by levels (steps, bisection, one pulse), without ramp, counter or overshoot.
//!
//! A trial is a list of acts that ends with a reading of the contacts, and a conclusion: the threshold or the next
//! level. The threshold lies between `untouched` and `changed`.
//!
//! The dwell at a level limits the resolution: the motion of the armature grows tenfold per 5.7 ms, so that 20 ms
//! resolve 16 mV, 30 ms less than 1 mV. A trial from rest approaches in two steps, as fine ramps do.

mod bisection;
mod outcome;
mod pulse;
mod staircase;
mod trial;

use super::pace::Pace;
use super::plan::Plan;
use super::{Context, TestRecord};
use crate::dut::em_relay::overshoot::CoarseResults;
use crate::dut::em_relay::threshold::Direction;
use crate::dut::em_relay::{Parameter, Strategy};
pub(super) use outcome::conclude;
pub(super) use trial::acts;
use units::{Celsius, Span, Volt};

/// Half width of the searched interval, in standard deviations of the lot.
const REACH: f64 = 4.5;
/// Half width for a search that only places a ramp, in standard deviations of the lot.
const WIDE: f64 = 6.0;
/// Largest and smallest overshoot of a coarse ramp, as multiples of the overshoot of usual parts. A dragging hinge
/// causes the largest.
const MOST_OVERSHOOT: f64 = 3.5;
const LEAST_OVERSHOOT: f64 = 0.3;
/// Lowest level of a search, as a fraction of nominal.
const LOWEST: f64 = 0.02;
/// Attempt number of a fine ramp that a search has placed.
pub(super) const AFTER_SEARCH: u8 = 2;

/// A search under way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Search {
    /// Strategy that chooses the levels.
    pub strategy: Strategy,
    /// Direction of the threshold.
    pub direction: Direction,
    /// Level nearest to the threshold at which the contact has not changed.
    pub untouched: Volt,
    /// Level nearest to the threshold at which the contact has changed; before any trial the end of the interval.
    pub changed: Volt,
    /// Level of the trial under way.
    pub at: Volt,
    /// Trials so far.
    pub trials: u32,
    /// Height of a step of a staircase.
    pub step: Volt,
    /// For each end of the interval, `[untouched, changed]`, true when a trial has confirmed it.
    pub seen: [bool; 2],
}

/// Consequence of a trial.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Next {
    /// A trial at another level.
    Try(Volt),
    /// Threshold, and its resolution.
    Found(Volt, Volt),
    /// The trial proves that the part keeps the limit.
    Proven,
    /// The search proves nothing, or the threshold lies outside the interval: ramps must measure it.
    Ramp,
}

impl Search {
    /// Returns the search under way in this direction, or a new one. Panics when the temperature of the part is
    /// unknown.
    pub(super) fn under_way(
        context: &Context,
        plan: &Plan,
        record: &TestRecord,
        direction: Direction,
    ) -> Self {
        let begun = plan.search.filter(|it| it.direction == direction);
        begun.unwrap_or_else(|| {
            let Some(part) = record.own.track else {
                panic!("a search for a threshold of a part of unknown temperature");
            };
            let strategy = context.strategy(parameter(direction));
            Self::new(context, strategy, direction, part)
        })
    }

    /// Begins a search over the interval that the recipe expects of the lot.
    fn new(context: &Context, strategy: Strategy, direction: Direction, part: Celsius) -> Self {
        let test = &context.relay.test;
        let (centre, sd) = test.expected(direction);
        let half = Volt(REACH * sd * direction.sign());
        let mut search = Self {
            strategy,
            direction,
            untouched: Volt(centre) - half,
            changed: Volt(centre) + half,
            at: Volt(centre) - half,
            step: context.scale().of_coil(staircase::STEP),
            trials: 0,
            seen: [false; 2],
        };
        search.at = match strategy {
            Strategy::Pulse => pulse::level(context, direction, part),
            Strategy::Bisection => bisection::level(&search),
            Strategy::Staircase
            | Strategy::Ramp
            | Strategy::TwoRates
            | Strategy::CoarseFine
            | Strategy::Adaptive => staircase::level(&search),
        };
        search
    }

    /// Begins a wide bisection that places a fine ramp where the coarse ramp gives no usable estimate.
    pub fn placing(context: &Context, record: &TestRecord, direction: Direction) -> Self {
        let (near, end) =
            overshot(context, record, direction).unwrap_or_else(|| far(context, direction));
        Self {
            strategy: Strategy::Bisection,
            direction,
            untouched: near,
            changed: end,
            at: (near + end) / 2.0,
            step: context.scale().of_coil(staircase::STEP),
            trials: 0,
            seen: [false; 2],
        }
    }

    /// Narrows the interval by the trial at [`Search::at`] and returns its consequence.
    fn after(&mut self, changed: bool) -> Next {
        self.trials += 1;
        self.seen[usize::from(changed)] = true;
        if changed {
            self.changed = self.at;
        } else {
            self.untouched = self.at;
        }
        match self.strategy {
            Strategy::Pulse => pulse::next(changed),
            Strategy::Bisection => bisection::next(self),
            Strategy::Staircase
            | Strategy::Ramp
            | Strategy::TwoRates
            | Strategy::CoarseFine
            | Strategy::Adaptive => staircase::next(self, changed),
        }
    }

    /// Returns true when the next trial starts from rest or from a sealed armature; false for a staircase, which
    /// continues from its last level.
    fn begins_anew(&self) -> bool {
        self.trials == 0 || self.strategy != Strategy::Staircase
    }

    fn dwell(&self, pace: Pace) -> Span {
        match (self.strategy, self.direction) {
            (Strategy::Staircase, _) => staircase::DWELL,
            (Strategy::Bisection, Direction::Falling) => bisection::SEALED_DWELL,
            (
                Strategy::Pulse
                | Strategy::Bisection
                | Strategy::Ramp
                | Strategy::TwoRates
                | Strategy::CoarseFine
                | Strategy::Adaptive,
                _,
            ) => pace.dwells(),
        }
    }
}

/// Returns the interval in which the threshold lies: the coarse indication less the largest and the smallest overshoot.
/// `None` without a coarse ramp.
fn overshot(context: &Context, record: &TestRecord, direction: Direction) -> Option<(Volt, Volt)> {
    let indicated = record.ramp(direction)?.coarse.indicated;
    let overshoot_v = context
        .overshoot(direction)
        .coarse
        .of(&CoarseResults::NONE)
        .volts;
    let [near, end] = [MOST_OVERSHOOT, LEAST_OVERSHOOT]
        .map(|overshoots| indicated - Volt(overshoots * overshoot_v));
    (near.0.is_finite() && near.0 > 0.0).then_some((near, end))
}

/// Returns an interval that extends far to both sides of the lot's thresholds, for release down to [`LOWEST`].
fn far(context: &Context, direction: Direction) -> (Volt, Volt) {
    let test = &context.relay.test;
    let (centre, sd) = test.expected(direction);
    let near = Volt(centre - WIDE * sd * direction.sign());
    let end = match direction {
        Direction::Rising => Volt(centre + WIDE * sd),
        Direction::Falling => Volt(LOWEST * context.relay.part.nominal_v),
    };
    (near, end)
}

/// Returns the parameter that a direction measures.
pub(super) fn parameter(direction: Direction) -> Parameter {
    match direction {
        Direction::Rising => Parameter::OperateVoltage,
        Direction::Falling => Parameter::ReleaseVoltage,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dut::em_relay::tests::context;

    /// Returns the levels tried against a threshold, and the consequence of the last.
    fn run(strategy: Strategy, direction: Direction, threshold: f64) -> (Vec<Volt>, Next) {
        let mut search = Search::new(&context(), strategy, direction, Celsius(23.0));
        let mut tried = Vec::new();
        loop {
            tried.push(search.at);
            let changed = (search.at.0 - threshold) * direction.sign() >= 0.0;
            match search.after(changed) {
                Next::Try(level) => search.at = level,
                other => return (tried, other),
            }
            assert!(tried.len() < 500, "endless");
        }
    }

    #[test]
    fn a_staircase_resolves_half_a_step() {
        for (direction, threshold) in [(Direction::Rising, 7.913), (Direction::Falling, 2.377)] {
            let (tried, next) = run(Strategy::Staircase, direction, threshold);
            let Next::Found(volts, step) = next else {
                panic!("{next:?}")
            };
            assert!((volts.0 - threshold).abs() <= step.0.abs() / 2.0 + 1e-9);
            let ahead = |pair: &[Volt]| (pair[1] - pair[0]).0 * direction.sign() > 0.0;
            assert!(tried.windows(2).all(ahead));
        }
    }

    #[test]
    fn seven_halvings_leave_1_128_of_the_interval() {
        let (tried, next) = run(Strategy::Bisection, Direction::Rising, 7.913);
        let Next::Found(volts, step) = next else {
            panic!("{next:?}")
        };
        assert_eq!(tried.len(), 7);
        let interval = 2.0 * REACH * context().relay.test.expected_operate_sd_v;
        assert!((step.0 - interval / 128.0).abs() < 1e-9);
        assert!((volts.0 - 7.913).abs() <= step.0 / 2.0 + 1e-9);
    }

    #[test]
    fn a_threshold_outside_the_interval_needs_ramps() {
        for strategy in [Strategy::Staircase, Strategy::Bisection] {
            assert_eq!(run(strategy, Direction::Rising, 9.5).1, Next::Ramp);
            assert_eq!(run(strategy, Direction::Rising, 5.0).1, Next::Ramp);
            assert_eq!(run(strategy, Direction::Falling, 0.8).1, Next::Ramp);
        }
    }

    #[test]
    fn a_pulse_proves_the_limit_or_needs_ramps() {
        let (tried, next) = run(Strategy::Pulse, Direction::Rising, 7.9);
        assert_eq!((tried.len(), next), (1, Next::Proven));
        assert!(tried[0] < Volt(9.0), "{}", tried[0]);
        assert_eq!(run(Strategy::Pulse, Direction::Rising, 8.999).1, Next::Ramp);
        assert_eq!(
            run(Strategy::Pulse, Direction::Falling, 2.3).1,
            Next::Proven
        );
        assert_eq!(
            run(Strategy::Pulse, Direction::Falling, 1.205).1,
            Next::Ramp
        );
    }
}
