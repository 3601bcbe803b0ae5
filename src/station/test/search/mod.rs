//! Thresholds by levels alone: steps, halved intervals, one pulse. No ramp, no counter, no lag.
//!
//! A trial is a list of acts that ends with a look at the contacts, and a conclusion that either has the
//! threshold or names the next level. Between `untouched` and `changed` lies the threshold.
//!
//! A level is held until the armature has had its chance: growth at the fold takes 5.7 ms per decade, so
//! 20 ms tell 16 mV, 30 ms less than 1 mV. A trial from rest approaches in two steps, as fine ramps do.

mod bisection;
mod pulse;
mod staircase;

use super::operate::{APPROACH, APPROACH_TIME, dropped};
use super::ramp::Expected;
use super::{Bench, Findings, INTERLOCK, OFF, Stage, board};
use crate::gauge::budget::{Budget, Reading, resolution};
use crate::gauge::coil::{relative_per_kelvin, to_reference};
use crate::gauge::threshold::Direction;
use crate::gauge::verdict::Judgement;
use crate::gauge::{Parameter, Strategy};
use crate::rig::point::DigitalOut::{
    Arm, CoilDrive, EventNoBreak, RampMode, SelectNo, SourceOn, SourceReverse,
};
use crate::rig::sample::CountSample;
use crate::station::act::{Act, Read, Readings};
use crate::station::supply::Supply;
use crate::units::{Celsius, Span, Volt};

/// The interval that is searched, in standard deviations of the lot.
const REACH: f64 = 4.5;
/// The interval of a search that only places a ramp, in standard deviations of the lot.
const WIDE: f64 = 6.0;
/// No release threshold is looked for below this fraction of nominal.
const LOWEST: f64 = 0.02;
/// Flux and armature from one level to the next while the armature is sealed.
const SEALS: Span = Span::ms(25);
/// Fraction of nominal at which the armature is sealed.
const SEAL: f64 = 0.95;

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
    /// Nothing is proven, or the interval does not hold the threshold: ramps must tell.
    Ramp,
}

impl Search {
    /// Over the interval that the lot leaves open.
    fn new(bench: &Bench, strategy: Strategy, direction: Direction, part: Celsius) -> Self {
        let test = &bench.recipe.test;
        let (centre, sd) = match direction {
            Direction::Rising => (test.expected_operate_v, test.expected_operate_sd_v),
            Direction::Falling => (test.expected_release_v, test.expected_release_sd_v),
        };
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
            Strategy::Pulse => pulse::level(bench, direction, part),
            Strategy::Bisection => bisection::level(&search),
            Strategy::Staircase
            | Strategy::Ramp
            | Strategy::TwoRates
            | Strategy::CoarseFine
            | Strategy::Adaptive => staircase::level(&search),
        };
        search
    }

    /// A wide one by halves, to place a fine ramp where the coarse one has told nothing, or something wrong.
    pub fn placing(bench: &Bench, direction: Direction) -> Self {
        let test = &bench.recipe.test;
        let far = |centre: f64, sd: f64| Volt(centre + WIDE * sd);
        let (near, end) = match direction {
            Direction::Rising => (
                far(test.expected_operate_v, -test.expected_operate_sd_v),
                far(test.expected_operate_v, test.expected_operate_sd_v),
            ),
            Direction::Falling => (
                far(test.expected_release_v, test.expected_release_sd_v),
                Volt(LOWEST * bench.recipe.part.nominal_v),
            ),
        };
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

    fn dwell(&self) -> Span {
        if self.strategy == Strategy::Staircase {
            staircase::DWELL
        } else {
            bisection::DWELL
        }
    }
}

pub(super) fn acts(
    bench: &Bench,
    supply: &mut Supply,
    findings: &mut Findings,
    direction: Direction,
) -> Vec<Act> {
    findings.armed = false;
    let Some(part) = findings.track else {
        return Vec::new();
    };
    let known = findings
        .search
        .filter(|search| search.direction == direction);
    let search = known.unwrap_or_else(|| {
        Search::new(bench, bench.strategy(parameter(direction)), direction, part)
    });
    findings.search = Some(search);
    let test = &bench.recipe.test;
    let near = Volt(test.expected_release_v + REACH * test.expected_release_sd_v);
    let mut acts = Vec::new();
    if search.begins_anew() {
        acts.extend(match direction {
            Direction::Rising => from_rest(supply, findings, search.at),
            Direction::Falling => from_sealed(bench, supply, findings, near),
        });
    }
    acts.extend([
        supply.step_to(search.at),
        Act::Wait(search.dwell()),
        Act::Read(Read::Board),
        Act::Mark,
    ]);
    acts
}

/// Off, then two steps towards `at`: a single one from zero picks up some 30 mV below the threshold.
fn from_rest(supply: &mut Supply, findings: &mut Findings, at: Volt) -> Vec<Act> {
    let mut acts = dropped(findings);
    let (coarse, takes) = supply.ramp_coarse(Volt(0.0));
    acts.extend([
        coarse,
        Act::WaitSinceMark(OFF),
        supply.step_to(at * APPROACH),
        board(&[
            (RampMode, false),
            (SelectNo, true),
            (EventNoBreak, false),
            (CoilDrive, true),
        ]),
        Act::Wait(APPROACH_TIME),
    ]);
    if supply.coarse() > Volt(0.1) {
        acts.push(Act::Wait(takes));
    }
    acts
}

/// Operated and sealed at 0.95 of nominal.
fn from_sealed(
    bench: &Bench,
    supply: &mut Supply,
    findings: &mut Findings,
    near: Volt,
) -> Vec<Act> {
    (findings.operated, findings.released) = (false, false);
    let mut acts = Vec::new();
    let (coarse, takes) = supply.ramp_coarse(Volt(0.0));
    if findings.operate.is_some() && findings.search.is_none_or(|search| search.trials == 0) {
        acts.extend([coarse, Act::Wait(takes)]);
    }
    acts.extend([
        supply.step_to(Volt(SEAL * bench.recipe.part.nominal_v)),
        board(&[
            (SourceOn, false),
            (SourceReverse, false),
            (RampMode, true),
            (SelectNo, true),
            (Arm, false),
            (CoilDrive, true),
        ]),
        Act::Wait(INTERLOCK + SEALS),
        // The flux of a sealed armature falls slowly: from the near end of the interval, not from above.
        supply.step_to(near),
        Act::Wait(SEALS),
    ]);
    acts
}

pub(super) fn conclude(
    bench: &Bench,
    readings: &Readings,
    findings: &mut Findings,
    direction: Direction,
) -> Option<Stage> {
    let (Some(seen), Some(mut search)) = (readings.boards.last(), findings.search) else {
        findings.void("interface board not read");
        return None;
    };
    let rising = direction == Direction::Rising;
    let next = search.after(seen.no_closed == rising);
    findings.operated = rising && seen.no_closed;
    findings.still_ramping = Span(0);
    if let Next::Try(level) = next {
        search.at = level;
        findings.search = Some(search);
        return Some(Stage::Search(direction));
    }
    findings.search = None;
    if bench.strategy(parameter(direction)).ramps() {
        return placed(bench, findings, direction, next);
    }
    match next {
        Next::Found(volts, step) => found(bench, findings, direction, volts, step, &readings.gates),
        Next::Proven => {
            let judgement = (parameter(direction), Judgement::Pass);
            findings.proven.push(judgement);
        }
        Next::Ramp if rising => return Some(Stage::OperateCoarse),
        Next::Ramp => return Some(Stage::ReleaseCoarse),
        Next::Try(_) => {}
    }
    None
}

/// The fine ramp goes where a search in its service has found the threshold.
fn placed(
    bench: &Bench,
    findings: &mut Findings,
    direction: Direction,
    next: Next,
) -> Option<Stage> {
    let Next::Found(volts, step) = next else {
        findings.void(format!(
            "{}: no threshold between the ends of the search",
            parameter(direction)
        ));
        return None;
    };
    *findings.expected(direction) = Some(near(bench, direction, volts, step));
    Some(match direction {
        Direction::Rising => Stage::OperateFine(AFTER_SEARCH),
        Direction::Falling => Stage::ReleaseFine(AFTER_SEARCH),
    })
}

/// Where a fine ramp will show a threshold that levels have found.
fn near(bench: &Bench, direction: Direction, volts: Volt, step: Volt) -> Expected {
    let lag = match direction {
        Direction::Rising => bench.operate_lag(),
        Direction::Falling => bench.release_lag(),
    };
    Expected::new(volts + Volt(lag.fine_v.value), step.0.abs().max(0.010))
}

fn found(
    bench: &Bench,
    findings: &mut Findings,
    direction: Direction,
    volts: Volt,
    step: Volt,
    samples: &[[CountSample; 2]],
) {
    let Some(part) = findings.track else { return };
    *findings.expected(direction) = Some(near(bench, direction, volts, step));
    let value = volts.0 * to_reference(part, bench.reference_temperature());
    let (level, kelvin) = (bench.calibration.level, bench.accuracy.part_minus_track_k);
    let budget = Budget::default()
        .with("level", (value * level.gain.u).hypot(level.offset_v.u))
        .with(
            "coil temperature",
            value * kelvin * relative_per_kelvin(part),
        )
        .with("strategy", resolution(step.0))
        .with_random("repeatability", bench.accuracy.operation_scatter_mv / 1e3);
    let reading = Reading { value, budget };
    findings.found(parameter(direction), reading, samples.iter().flatten());
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
    use crate::station::tests::bench;

    /// Levels tried against a threshold, and what came of it.
    fn run(strategy: Strategy, direction: Direction, threshold: f64) -> (Vec<Volt>, Next) {
        let mut search = Search::new(&bench(), strategy, direction, Celsius(23.0));
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
        let interval = 2.0 * REACH * bench().recipe.test.expected_operate_sd_v;
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
