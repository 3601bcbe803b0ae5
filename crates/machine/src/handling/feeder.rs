//! The feeder: steps pocket, nests, gripper and bins once per turn.
//!
//! The feeder steps the sorter first and the feed last, so that a place is free before the next part moves there.

use super::feed::Feed;
use super::ledger::Ledger;
use super::moves::Move;
use super::nest::{self, Nest, NestContext, NestState, TestTerms};
use super::output::NestDone;
use super::place::{NestId, Place};
use super::sort::{self, Sort};
use super::turn::Turn;
use crate::dut::Procedure;
use crate::guard::PartPlaces;
use crate::rig::axis::AxisTable;
use crate::rig::bin::Bin;
use crate::rig::point::DigitalInput;
use units::RigTime;

/// Actions that may begin in a turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Permits {
    /// Further parts may leave the magazine.
    pub release: bool,
    /// The part in the pocket may be pushed into the nest.
    pub push: bool,
}

/// States of feed, nests and sorter.
#[derive(Debug)]
pub struct Feeder {
    table: AxisTable,
    feed: Feed,
    nests: Vec<Nest>,
    sort: Sort,
    /// True when a part may have passed the escapement before the sequence was cut off.
    releasing: bool,
    last_left: Option<RigTime>,
}

impl Feeder {
    /// Makes a feeder with one nest; the sequence begins with empty places.
    pub fn new(table: AxisTable) -> Self {
        Self {
            table,
            feed: Feed::Empty,
            nests: vec![Nest::new(NestId::FIRST)],
            sort: Sort::Returning,
            releasing: false,
            last_left: None,
        }
    }

    /// Steps the feeder once; returns true when a nest has received a new part.
    pub fn step(
        &mut self,
        turn: &mut Turn,
        mut job: Option<NestDone>,
        terms: TestTerms,
        permits: Permits,
    ) -> bool {
        let holds = |nest: &Nest| matches!(nest.state, NestState::Testing(_) | NestState::Judged);
        let test_running = self.nests.iter().any(holds);
        self.sort = self.sort.step(turn, &self.table, test_running);
        let mut is_new = false;
        for nest in &mut self.nests {
            let was_empty = matches!(nest.state, NestState::Empty);
            let context = NestContext {
                done: nest::answer_for(nest.id, &mut job),
                terms,
                sort: &mut self.sort,
                last_left: &mut self.last_left,
            };
            nest.step(turn, context);
            is_new |= was_empty && !matches!(nest.state, NestState::Empty);
        }
        assert!(job.is_none(), "a job done for a nest that does not exist");
        assert!(!self.nests.is_empty(), "a feeder without a nest");
        let free = self.nests[0].id;
        self.feed = self.feed.step(turn, free, permits.release, permits.push);
        is_new
    }

    /// Looks for the falling part at its beam, even while the sequence is stopped.
    pub fn confirm(&self, turn: &mut Turn) {
        sort::confirm(turn, &self.table);
    }

    /// Records that a cleared motion was driven; fingers that open release their part.
    pub fn driven(&mut self, movement: Move, ledger: &mut Ledger, now: RigTime) {
        self.sort = self.sort.driven(movement, ledger, now);
    }

    /// Records that every output has its safe value, so that every motion has ended.
    pub fn cut_off(&mut self, ledger: &Ledger) {
        self.releasing |= matches!(self.feed, Feed::Releasing { .. } | Feed::Closing { .. });
        self.reset_states(ledger);
    }

    /// Resumes the sequence after homing, from the parts inside.
    pub fn resume(&mut self, ledger: &Ledger) {
        self.releasing = false;
        self.last_left = None;
        self.reset_states(ledger);
        if ledger.holds(Place::Gripper) {
            self.sort = Sort::Loaded;
        }
    }

    fn reset_states(&mut self, ledger: &Ledger) {
        self.feed = match ledger.holds(Place::Pocket) {
            true => Feed::Ready,
            false => Feed::Empty,
        };
        for nest in &mut self.nests {
            nest.state = NestState::Empty;
        }
        self.sort = Sort::Returning;
    }

    /// Returns true when a part may have passed the escapement before the sequence was cut off.
    pub fn is_releasing(&self) -> bool {
        self.releasing
    }

    /// Returns the state of the feed.
    pub fn feed(&self) -> Feed {
        self.feed
    }

    /// Returns the nests.
    pub fn nests(&self) -> &[Nest] {
        &self.nests
    }

    /// Returns the state of the sorter.
    pub fn sort(&self) -> Sort {
        self.sort
    }

    /// Returns the test under way, if there is one.
    pub fn test(&self) -> Option<&Procedure> {
        self.nests.iter().find_map(Nest::test)
    }

    /// Yields the beam in the chute of each bin, in the order of the line.
    pub fn beams(&self) -> impl Iterator<Item = (Bin, DigitalInput)> + '_ {
        self.table.bins().map(|bin| (bin, self.table.beam(bin)))
    }

    /// Returns the places of parts for the guard.
    pub fn part_places(&self, ledger: &Ledger) -> PartPlaces {
        let pushing = self.feed == Feed::Pushing;
        let lifts = |nest: &Nest| matches!(nest.state, NestState::Lifting);
        let lifting = self.nests.iter().any(lifts);
        let waits = ledger.holds(Place::Pocket);
        PartPlaces {
            pocket: waits && !pushing,
            on_pusher: waits && pushing,
            nest: ledger.holds(Place::NEST) && !lifting,
            gripper: ledger.holds(Place::Gripper) || lifting,
        }
    }

    /// Returns true when every part is in a waiting position; `bin_full`: a part may wait over its bin.
    pub fn is_at_rest(&self, bin_full: bool) -> bool {
        let rests = |nest: &Nest| matches!(nest.state, NestState::Empty | NestState::Judged);
        let over_bin = matches!(self.sort, Sort::OverBin(..)) && bin_full;
        let sort = matches!(self.sort, Sort::OverNest | Sort::AtPart) || over_bin;
        self.nests.iter().all(rests) && sort && self.feed_rests()
    }

    /// Returns true when neither the feed nor the sorter is moving a part.
    pub fn moves_no_part(&self) -> bool {
        let sort = matches!(self.sort, Sort::Returning | Sort::OverNest | Sort::Opening);
        sort && self.feed_rests()
    }

    fn feed_rests(&self) -> bool {
        match self.feed {
            Feed::Empty | Feed::Ready => true,
            Feed::Releasing { .. }
            | Feed::Closing { .. }
            | Feed::Holding
            | Feed::Pushing
            | Feed::Retracting => false,
        }
    }
}
