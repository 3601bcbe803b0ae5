//! The nest takes a part, tests it and hands it to the gripper, and never releases it in between.

use super::{MockRig, context, device};
use crate::dut::em_relay::points::DigitalOut;
use crate::dut::{Bin, Reason, Verdict};
use crate::handling::mechanism::DEBOUNCE;
use crate::handling::moves::Move;
use crate::handling::nest::{self, NestContext, NestState, TestTerms};
use crate::handling::output::NestJob;
use crate::handling::place::{NestId, Place};
use crate::handling::sort::Sort;
use crate::instrument::act::{Job, JobDone};
use crate::rig::axis::AxisStation;
use crate::rig::point::DigitalIn;
use texts::Message;
use units::{RigTime, Second};

/// A nest with its surroundings.
struct Nest {
    mock: MockRig,
    sort: Sort,
    last_left: Option<RigTime>,
}

impl Nest {
    /// Makes a nest with a part just pushed in; the pusher is still there, the axis waits over the nest.
    fn loaded(reference: Option<String>) -> Self {
        let mut mock = MockRig::at_rest();
        mock.carried_out(Move::AxisTo(AxisStation::Nest));
        mock.ledger.enter_pocket();
        mock.ledger.enter_nest(NestId::FIRST, reference);
        mock.set(DigitalIn::NestPresent, true);
        mock.show_end(Move::PusherExtend);
        mock.scan();
        Self {
            mock,
            sort: Sort::OverNest,
            last_left: None,
        }
    }

    fn step(&mut self, state: NestState, done: Option<JobDone>) -> NestState {
        let device = device();
        let context = NestContext {
            done,
            terms: TestTerms {
                device: &device,
                thorough: false,
                teaching: None,
            },
            sort: &mut self.sort,
            last_left: &mut self.last_left,
        };
        let id = NestId::FIRST;
        let mut nest = nest::Nest { id, state };
        nest.step(&mut self.mock.turn(), context);
        nest.state
    }

    fn motions(&self) -> &[Move] {
        &self.mock.output.rig.motions
    }

    /// Steps up to the first job of the test.
    fn testing(&mut self) -> NestState {
        let state = self.step(NestState::Empty, None);
        assert_eq!(self.motions(), [Move::ClampClose]);
        self.mock.carried_out(Move::ClampClose);
        let state = self.step(state, None);
        assert!(self.motions().is_empty(), "the pusher is not back");
        self.mock.carried_out(Move::PusherRetract);
        let state = self.step(state, None);
        assert_eq!(self.motions(), [Move::ProbesUp]);
        self.mock.carried_out(Move::ProbesUp);
        self.step(state, None)
    }

    /// Fails the first job of the test 40 ms after its start, so that the part is judged void.
    fn judged(&mut self) -> NestState {
        let state = self.testing();
        self.fails(state)
    }

    fn fails(&mut self, state: NestState) -> NestState {
        self.mock.after(40);
        let failed = JobDone::new(self.mock.now, Some(silent()));
        // The first failure ends the stage, the second ends the switching off after it.
        let state = self.step(state, Some(failed.clone()));
        assert!(matches!(state, NestState::Testing(_)));
        self.step(state, Some(failed))
    }

    fn fingers_around(&mut self) {
        self.mock.carried_out(Move::SortDown);
        self.sort = Sort::AtPart;
    }
}

/// Returns the first job of a test.
fn pins() -> NestJob {
    NestJob {
        nest: NestId::FIRST,
        job: Job::Set(vec![(
            context().points.output(DigitalOut::KelvinTest),
            true,
        )]),
    }
}

fn silent() -> Message {
    Message::detail("unread", "measure 05: silent")
}

#[test]
fn probes_rise_before_the_leaving_pusher_is_back() {
    let mut nest = Nest::loaded(None);
    let mock = &mut nest.mock;
    mock.mechanism
        .driven(Move::PusherRetract, mock.now, &mock.image);
    let state = nest.step(NestState::Empty, None);
    nest.mock.carried_out(Move::ClampClose);
    let state = nest.step(state, None);
    assert!(nest.motions().is_empty(), "the pusher is at the nest");
    let mock = &mut nest.mock;
    mock.set(DigitalIn::PusherExtended, false);
    mock.scan();
    mock.mechanism.update(mock.now, &mock.image);
    mock.after(DEBOUNCE.0 / 1000);
    mock.scan();
    mock.mechanism.update(mock.now, &mock.image);
    let state = nest.step(state, None);
    assert_eq!(nest.motions(), [Move::ProbesUp]);
    nest.mock.carried_out(Move::ProbesUp);
    assert!(matches!(nest.step(state, None), NestState::Testing(_)));
}

#[test]
fn an_empty_nest_requests_nothing() {
    let mut nest = Nest::loaded(None);
    nest.mock.ledger = Default::default();
    let state = nest.step(NestState::Empty, None);
    assert!(matches!(state, NestState::Empty) && nest.motions().is_empty());
}

#[test]
fn with_probes_up_the_test_begins_with_the_pins() {
    let mut nest = Nest::loaded(None);
    let state = nest.testing();
    assert!(matches!(state, NestState::Testing(_)));
    assert_eq!(nest.mock.output.rig.job, Some(pins()));
    let part = nest.mock.ledger.part(Place::NEST).unwrap();
    assert_eq!(part.probed_at, Some(nest.mock.now));
}

#[test]
fn a_failed_job_sends_the_part_to_retest() {
    let mut nest = Nest::loaded(None);
    let state = nest.judged();
    assert!(matches!(state, NestState::Judged));
    let judged = &nest.mock.output.parts.judged[0];
    let why = Verdict::Void(vec![Reason::rig_trouble(silent())]);
    assert_eq!(
        (&judged.verdict, judged.part.bin),
        (&why, Some(Bin::RETEST))
    );
    assert_eq!(judged.part.test, Some(Second(0.04)));
    let part = nest.mock.ledger.part(Place::NEST);
    assert_eq!(part, Some(&judged.part));
}

#[test]
fn a_void_reference_part_is_tested_three_times() {
    let mut nest = Nest::loaded(Some("G-12-1".into()));
    let mut state = nest.judged();
    for tests in 1..3 {
        assert!(nest.mock.output.parts.judged.is_empty(), "after {tests}");
        let job = &nest.mock.output.rig.job;
        assert_eq!(*job, Some(pins()), "from the beginning");
        state = nest.fails(state);
    }
    assert!(matches!(state, NestState::Judged));
    let part = &nest.mock.output.parts.judged[0].part;
    assert_eq!(part.bin, Some(Bin::RETEST));
    assert_eq!(format!("{:?}", part.role), "Reference(\"G-12-1\")");
}

#[test]
fn the_nest_holds_a_judged_part_until_gripped() {
    let mut nest = Nest::loaded(None);
    let state = nest.judged();
    let state = nest.step(state, None);
    assert!(nest.motions().is_empty(), "no fingers around it");
    nest.fingers_around();
    let state = nest.step(state, None);
    assert_eq!(nest.motions(), [Move::ProbesDown, Move::GripperClose]);
    nest.mock.carried_out(Move::ProbesDown);
    let state = nest.step(state, None);
    assert!(nest.motions().is_empty(), "the gripper is not closed");
    nest.mock.carried_out(Move::GripperClose);
    let state = nest.step(state, None);
    assert_eq!(nest.motions(), [Move::ClampOpen]);
    nest.mock.carried_out(Move::ClampOpen);
    let state = nest.step(state, None);
    assert_eq!(nest.motions(), [Move::SortUp]);
    assert!(matches!(state, NestState::Lifting));
}

fn lift(nest: &mut Nest) -> NestState {
    let state = nest.judged();
    nest.fingers_around();
    let mut state = nest.step(state, None);
    for movement in [Move::ProbesDown, Move::GripperClose, Move::ClampOpen] {
        nest.mock.carried_out(movement);
        state = nest.step(state, None);
    }
    nest.mock.carried_out(Move::SortUp);
    state
}

#[test]
fn the_gripper_owns_the_part_once_z_is_up() {
    let mut nest = Nest::loaded(None);
    let state = lift(&mut nest);
    let state = nest.step(state, None);
    assert!(matches!(state, NestState::Lifting), "nest still occupied");
    assert!(!nest.mock.ledger.holds(Place::Gripper));
    nest.mock.set(DigitalIn::NestPresent, false);
    nest.mock.after(8);
    let state = nest.step(state, None);
    assert!(matches!(state, NestState::Empty));
    assert!(nest.mock.ledger.holds(Place::Gripper) && !nest.mock.ledger.holds(Place::NEST));
    assert_eq!(nest.sort, Sort::Loaded);
}

#[test]
fn the_cycle_time_begins_with_the_second_part() {
    for (before_ms, cycle) in [(None, None), (Some(500), Some(0.5))] {
        let mut nest = Nest::loaded(None);
        let state = lift(&mut nest);
        nest.mock.set(DigitalIn::NestPresent, false);
        nest.mock.after(8);
        nest.last_left = before_ms.map(|ms: u64| RigTime(nest.mock.now.0 - ms * 1000));
        nest.step(state, None);
        let left = nest.mock.output.parts.left[0];
        assert_eq!((left.ordinal, left.cycle), (1, cycle.map(Second)));
        assert_eq!(nest.last_left, Some(nest.mock.now));
    }
}

#[test]
fn an_interrupted_part_is_clamped_and_not_tested() {
    let mut nest = Nest::loaded(None);
    let part = nest.mock.ledger.part_mut(Place::NEST).unwrap();
    part.interrupted = Some("emergency_stop".into());
    let state = nest.step(NestState::Empty, None);
    nest.mock.carried_out(Move::ClampClose);
    nest.mock.carried_out(Move::PusherRetract);
    let state = nest.step(state, None);
    assert!(matches!(state, NestState::Judged) && nest.motions().is_empty());
    let part = nest.mock.ledger.part(Place::NEST).unwrap();
    assert_eq!(
        (part.bin, nest.mock.output.parts.judged.len()),
        (Some(Bin::RETEST), 1)
    );
}
