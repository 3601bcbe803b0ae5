//! Timeouts of the steps of feed, nests and sorter.
//!
//! | step | waits for | at most |
//! |---|---|---|
//! | feed on its way | strokes, each with its own time-out and one more try | 6 s |
//! | clamping, probing, gripping, unclamping | strokes | 6 s |
//! | testing | all measurements, of which those that confirm take less than 10 s | 60 s plus the longest conditioning |
//! | judged, still clamped | the sorter over the nest, fingers open, z down | 15 s |
//! | lifting | z up and the nest empty | 2.5 s |
//! | sorter on its way | strokes and the axis | 8 s |
//! | over the bin | rows of the part on the disk, a reading of the beam, the landing of the previous part | 15 s |
//!
//! The other steps have no timeout: they wait for a neighbour that has one, or for parts. A full bin stops the clock of
//! the step over the bin. In maintenance, and while an unattended run waits for its history, no timeout applies.

use super::catalogue::AlarmCode;
use super::packml::{Mode, State};
use super::trouble::Alarm;
use crate::handling::Feeder;
use crate::handling::feed::Feed;
use crate::handling::nest::NestState;
use crate::handling::place::NestId;
use crate::handling::sort::Sort;
use units::{RigTime, Span};

/// Part of the feeder to which a step belongs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Owner {
    Feed,
    Nest(NestId),
    Sort,
}

/// A step under way.
#[derive(Debug, Clone, Copy)]
struct Step {
    who: Owner,
    /// Code of its text in family `step`, which has texts only for steps with a limit.
    name: &'static str,
    limit: Option<Span>,
}

/// Start times of the steps of feed, nests and sorter.
#[derive(Debug, Default)]
pub struct Timeouts {
    since: Vec<(Owner, &'static str, RigTime)>,
}

impl Timeouts {
    /// Restarts every clock, because the rig has entered another PackML state.
    pub fn forget(&mut self) {
        self.since.clear();
    }

    /// Returns the alarm of a step that has exceeded its timeout, if there is one; of several steps, the one furthest
    /// along the feeder. A rack has its timeouts in the batch.
    pub fn look(
        &mut self,
        now: RigTime,
        state: State,
        mode: Mode,
        feeder: Option<&Feeder>,
    ) -> Option<Alarm> {
        let feeder = feeder?;
        if !runs(state) || mode == Mode::Maintenance {
            self.forget();
            return None;
        }
        let machines = feeder.nests().len() + 2;
        assert!(self.since.len() <= machines, "a clock of no machine");
        let mut late = None;
        for step in steps(feeder) {
            let began = self.began(step, now);
            assert!(began <= now, "{} began in the future", step.name);
            let waited = now.since(began);
            if step.limit.is_some_and(|limit| waited > limit) {
                late = Some(match step.name {
                    LIFTING => AlarmCode::PartStuck.into(),
                    name => Alarm::step_too_long(name, waited),
                });
            }
        }
        late
    }

    /// Returns the start time of a step; a step that is not yet known begins now.
    fn began(&mut self, step: Step, now: RigTime) -> RigTime {
        match self.since.iter_mut().find(|(who, ..)| *who == step.who) {
            Some((_, name, began)) => {
                if *name != step.name {
                    (*name, *began) = (step.name, now);
                }
                *began
            }
            None => {
                self.since.push((step.who, step.name, now));
                now
            }
        }
    }

    /// Restarts the clock of the sorter while a bin is full.
    pub fn wait_for_bin(&mut self) {
        self.since.retain(|(who, ..)| *who != Owner::Sort);
    }
}

/// The step whose timeout means that a part is stuck.
const LIFTING: &str = "lifting";

fn steps(feeder: &Feeder) -> impl Iterator<Item = Step> {
    let step = |who, (name, limit)| Step { who, name, limit };
    let nests = feeder.nests().iter();
    std::iter::once(step(Owner::Feed, of_feed(feeder.feed())))
        .chain(nests.map(move |nest| step(Owner::Nest(nest.id), of_nest(&nest.state))))
        .chain([step(Owner::Sort, of_sort(feeder.sort()))])
}

fn runs(state: State) -> bool {
    matches!(
        state,
        State::Resetting
            | State::Execute
            | State::Completing
            | State::Stopping
            | State::Holding
            | State::Suspending
    )
}

fn of_feed(feed: Feed) -> (&'static str, Option<Span>) {
    let stroke = Some(Span::ms(6000));
    match feed {
        Feed::Empty => ("feed_empty", None),
        Feed::Releasing { .. } => ("releasing", stroke),
        Feed::Closing { .. } => ("escapement_closing", stroke),
        Feed::Holding => ("escapement_holding", stroke),
        Feed::Ready => ("part_ready", None),
        Feed::Pushing => ("pushing", stroke),
        Feed::Retracting => ("retracting", stroke),
    }
}

fn of_nest(nest: &NestState) -> (&'static str, Option<Span>) {
    let stroke = Some(Span::ms(6000));
    match nest {
        NestState::Empty => ("nest_empty", None),
        NestState::Clamping => ("clamping", stroke),
        NestState::Probing => ("probing", stroke),
        NestState::Testing(test) => ("testing", Some(test.longest())),
        NestState::Judged => ("waiting_for_the_gripper", Some(Span::ms(15_000))),
        NestState::Gripping => ("gripping", stroke),
        NestState::Unclamping => ("unclamping", stroke),
        NestState::Lifting => (LIFTING, Some(Span::ms(2500))),
    }
}

fn of_sort(sort: Sort) -> (&'static str, Option<Span>) {
    let stroke = Some(Span::ms(8000));
    match sort {
        Sort::Returning => ("axis_returning", stroke),
        Sort::OverNest => ("over_the_nest", None),
        Sort::Lowering => ("z_lowering", stroke),
        Sort::AtPart => ("fingers_around_the_part", None),
        Sort::Loaded => ("loaded", stroke),
        Sort::Carrying(_) => ("carrying", stroke),
        Sort::OverBin(..) => ("over_the_bin", Some(Span::ms(15_000))),
        Sort::LettingGo(..) => ("letting_go", stroke),
        Sort::Opening => ("fingers_opening", stroke),
    }
}
