//! Thresholds by levels alone: steps, halved intervals, one pulse. No ramp, no counter, no overshoot.
//!
//! A trial is a list of acts that ends with a look at the contacts, and a conclusion that either has the
//! threshold or names the next level. Between `untouched` and `changed` lies the threshold.
//!
//! A trial holds its level until the armature has had its chance: growth at the fold takes 5.7 ms per decade, so
//! 20 ms resolve 16 mV, 30 ms less than 1 mV. A trial from rest approaches in two steps, as fine ramps do.

mod bisection;
mod outcome;
mod pulse;
mod staircase;
mod trial;

use super::pace::Pace;
use super::plan::Plan;
use super::{Context, TestRecord};
use crate::dut::em_relay::overshoot::Shown;
use crate::dut::em_relay::threshold::Direction;
use crate::dut::em_relay::{Parameter, Strategy};
pub(super) use outcome::conclude;
pub(super) use trial::acts;
use units::{Celsius, Span, Volt};

/// The interval that is searched, in standard deviations of the lot.
const REACH: f64 = 4.5;
/// The interval of a search that only places a ramp, in standard deviations of the lot.
const WIDE: f64 = 6.0;
/// A coarse ramp has overshot by as many times what it overshoots on other parts: a dragging hinge by the most.
const MOST_OVERSHOOT: f64 = 3.5;
const LEAST_OVERSHOOT: f64 = 0.3;
/// The search goes no lower than this fraction of nominal.
const LOWEST: f64 = 0.02;
/// Number of the attempt of a fine ramp that a search has placed.
pub(super) const AFTER_SEARCH: u8 = 2;

/// A search under way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Search {
    /// How levels are chosen.
    pub strategy: Strategy,
    /// Which way.
    pub direction: Direction,
    /// The contact stayed at this level.
    pub untouched: Volt,
    /// It changed at this one; at first the end of the interval.
    pub changed: Volt,
    /// The level of the trial under way.
    pub at: Volt,
    /// Trials so far.
    pub trials: u32,
    /// Whether any trial left the contact untouched, and whether any changed it: an end that no trial has
    /// seen bounds nothing.
    pub seen: [bool; 2],
}

/// What a trial leads to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Next {
    /// Another level.
    Try(Volt),
    /// The threshold lies here, known to this step.
    Found(Volt, Volt),
    /// The limit is kept.
    Proven,
    /// Nothing is proven, or the interval does not hold the threshold: ramps must measure it.
    Ramp,
}

impl Search {
    /// The search that the plan has under way in this direction, or a new one. Panics while the temperature of the part is
    /// not known.
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

    /// Over the interval that the lot leaves open.
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

    /// A wide one by halves, to place a fine ramp where the coarse one has shown nothing, or something wrong.
    pub fn placing(context: &Context, record: &TestRecord, direction: Direction) -> Self {
        let (near, end) =
            overshot(context, record, direction).unwrap_or_else(|| far(context, direction));
        Self {
            strategy: Strategy::Bisection,
            direction,
            untouched: near,
            changed: end,
            at: (near + end) / 2.0,
            trials: 0,
            seen: [false; 2],
        }
    }

    /// After a trial at [`Search::at`].
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

    /// Every trial but those of a staircase begins from rest, or from a sealed armature.
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

/// Between the ends of what a coarse ramp may have overshot by, if there was one.
fn overshot(context: &Context, record: &TestRecord, direction: Direction) -> Option<(Volt, Volt)> {
    let indicated = record.ramp(direction)?.coarse.indicated;
    let overshoot_v = context
        .overshoot(direction)
        .coarse
        .of(&Shown::NOTHING)
        .volts;
    let [near, end] = [MOST_OVERSHOOT, LEAST_OVERSHOOT]
        .map(|overshoots| indicated - Volt(overshoots * overshoot_v));
    (near.0.is_finite() && near.0 > 0.0).then_some((near, end))
}

/// Far to both sides of the lot, but not below [`LOWEST`].
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

/// What a direction measures.
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

    /// Levels tried against a threshold, and what came of it.
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
    fn a_staircase_finds_a_threshold_to_half_a_step_and_never_steps_back() {
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
    fn seven_halvings_leave_a_hundred_and_twenty_eighth_of_the_interval() {
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
    fn a_threshold_outside_the_interval_is_no_number() {
        for strategy in [Strategy::Staircase, Strategy::Bisection] {
            assert_eq!(run(strategy, Direction::Rising, 9.5).1, Next::Ramp);
            assert_eq!(run(strategy, Direction::Rising, 5.0).1, Next::Ramp);
            assert_eq!(run(strategy, Direction::Falling, 0.8).1, Next::Ramp);
        }
    }

    #[test]
    fn a_pulse_inside_the_limit_proves_or_leaves_it_to_ramps() {
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
