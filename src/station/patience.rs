//! How long each step may wait: the deadline of every state that has none of its own.
//!
//! | step | waits for | at most |
//! |---|---|---|
//! | feed on its way | strokes, each with its own time-out and one more try | 6 s |
//! | clamping, probing, gripping, unclamping | strokes | 6 s |
//! | testing | the measuring line; the slow strategy takes below 10 s | 60 s |
//! | judged | the sorter over the nest, fingers open, z down | 15 s |
//! | lifting | z up and the nest empty | 2.5 s |
//! | sorter on its way | strokes and the axis | 8 s |
//! | over the bin | rows of the part durable, beam read, the part before landed | 15 s |
//!
//! The others wait for their neighbours, which have a deadline, or for parts, which are nobody's fault.
//! A bin that is full stops the clock over the bin; in maintenance nothing is late.

use super::clamp::Clamp;
use super::feed::Feed;
use super::packml::{Mode, State};
use super::sort::Sort;
use super::trouble::Alarm;
use crate::units::{RigTime, Span};

/// Since when feed, nest and sorter are in their step.
#[derive(Debug, Default)]
pub struct Patience {
    since: [Option<(&'static str, RigTime)>; 3],
}

impl Patience {
    /// A new state of the outer machine: every clock begins anew.
    pub fn forget(&mut self) {
        self.since = [None; 3];
    }

    /// The first step that waits for too long.
    pub fn look(
        &mut self,
        now: RigTime,
        state: State,
        mode: Mode,
        feed: &Feed,
        clamp: &Clamp,
        sort: Sort,
    ) -> Option<Alarm> {
        if !runs(state) || mode == Mode::Maintenance {
            self.forget();
            return None;
        }
        let mut late = None;
        for (since, (name, limit)) in
            self.since
                .iter_mut()
                .zip([of_feed(*feed), of_clamp(clamp), of_sort(sort)])
        {
            let began = match *since {
                Some((known, began)) if known == name => began,
                Some(_) | None => now,
            };
            *since = Some((name, began));
            let waited = now.since(began);
            if limit.is_some_and(|limit| waited > limit) {
                late = Some(match clamp {
                    Clamp::Lifting if name == "lifting" => Alarm::part_stuck(),
                    _other => Alarm::step_too_long(name, waited),
                });
            }
        }
        late
    }

    /// A bin is full: what waits over it is not late.
    pub fn wait_for_bin(&mut self) {
        self.since[2] = None;
    }
}

/// The sequence turns in these states.
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
        Feed::Empty => ("feed empty", None),
        Feed::Releasing { .. } => ("releasing", stroke),
        Feed::Closing { .. } => ("escapement closing", stroke),
        Feed::Holding => ("escapement holding", stroke),
        Feed::Ready => ("part ready", None),
        Feed::Pushing => ("pushing", stroke),
        Feed::Retracting => ("retracting", stroke),
    }
}

fn of_clamp(clamp: &Clamp) -> (&'static str, Option<Span>) {
    let stroke = Some(Span::ms(6000));
    match clamp {
        Clamp::Empty => ("nest empty", None),
        Clamp::Clamping => ("clamping", stroke),
        Clamp::Probing => ("probing", stroke),
        Clamp::Testing(_) => ("testing", Some(Span::ms(60_000))),
        Clamp::Judged => ("waiting for the gripper", Some(Span::ms(15_000))),
        Clamp::Gripping => ("gripping", stroke),
        Clamp::Unclamping => ("unclamping", stroke),
        Clamp::Lifting => ("lifting", Some(Span::ms(2500))),
    }
}

fn of_sort(sort: Sort) -> (&'static str, Option<Span>) {
    let stroke = Some(Span::ms(8000));
    match sort {
        Sort::Returning => ("axis returning", stroke),
        Sort::OverNest => ("over the nest", None),
        Sort::Lowering => ("z lowering", stroke),
        Sort::AtPart => ("fingers around the part", None),
        Sort::Loaded => ("loaded", stroke),
        Sort::Carrying(_) => ("carrying", stroke),
        Sort::OverBin(..) => ("over the bin", Some(Span::ms(15_000))),
        Sort::LettingGo(..) => ("letting go", stroke),
        Sort::Opening => ("fingers opening", stroke),
    }
}
