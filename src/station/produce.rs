//! Feed, nest and sorter, once each per turn, and when they are through.

use super::Station;
use super::clamp::{Beside, Clamp};
use super::feed::Feed;
use super::mechanism::DEBOUNCE;
use super::packml::Mode;
use super::sort::Sort;
use super::wants::{Inputs, Wants};
use crate::instrument::act::JobDone;
use crate::units::RigTime;
use std::sync::Arc;

impl Station {
    /// One turn of the sequence. `wanted`: further parts may leave the magazine; `push`: the part in the
    /// pocket may go to the nest.
    pub(super) fn produce(
        &mut self,
        now: RigTime,
        mut inputs: Inputs,
        wants: &mut Wants,
        wanted: bool,
        push: bool,
    ) {
        let job: Option<JobDone> = inputs.job.take();
        self.note_begin(wants);
        let test_running = matches!(self.clamp, Clamp::Testing(_) | Clamp::Judged);
        let was_empty = matches!(self.clamp, Clamp::Empty);
        let (feed, clamp) = (self.feed, std::mem::replace(&mut self.clamp, Clamp::Empty));
        let (mut sort, mut last_left) = (self.sort, self.last_left);
        let (device, thorough) = (Arc::clone(&self.device), self.is_thorough());
        let teaching = self.teaching().map(str::to_owned);
        let table = self.table.clone();
        let before = wants.motions.len();
        let mut turn = self.turn(now, &inputs, wants);
        sort = sort.step(&mut turn, &table, test_running);
        let beside = Beside {
            job,
            device: &device,
            thorough,
            teaching: teaching.as_deref(),
            sort: &mut sort,
            last_left: &mut last_left,
        };
        let clamp = clamp.step(&mut turn, beside);
        let feed = feed.step(&mut turn, wanted, push);
        drop(device);
        if was_empty && !matches!(clamp, Clamp::Empty) {
            self.mechanism.new_part();
        }
        (self.feed, self.clamp, self.sort, self.last_left) = (feed, clamp, sort, last_left);
        if self.mode == Mode::Maintenance {
            self.stepwise.extend(wants.motions.drain(before..));
        }
        self.learn(wants);
    }

    /// No motion begins while an end sensor is in doubt: the guard would have to assume the whole stroke.
    pub(super) fn postpone(&mut self, now: RigTime, wants: &mut Wants) {
        self.postponed.append(&mut wants.motions);
        if self.mechanism.is_in_doubt() {
            let soon = now + DEBOUNCE;
            wants.wake_at = Some(wants.wake_at.map_or(soon, |at| at.min(soon)));
        } else {
            wants.motions.append(&mut self.postponed);
        }
        let waiting = self.stepwise.iter().chain(&self.postponed).copied();
        self.mechanism.keep_waiting(&waiting.collect::<Vec<_>>());
    }

    fn note_begin(&mut self, wants: &mut Wants) {
        let known = self.device.is_calibrated();
        if !self.lot_began && self.golden_left.is_empty() && known {
            self.lot_began = true;
            wants.lot_began = true;
        }
    }

    /// Parts of the lot still to come out of the magazine.
    pub(super) fn wants_more(&self) -> bool {
        self.plan
            .count
            .is_none_or(|count| self.ledger.own() < self.golden_planned + count)
    }

    /// Nothing inside but, without `pocket`, a part that waits there; rows of the last one are durable.
    pub(super) fn is_finished(&self, pocket: bool, recorded: u64, wants: &Wants) -> bool {
        let ledger = &self.ledger;
        let empty = ledger.nest.is_none() && ledger.gripper.is_none() && ledger.falling.is_none();
        let waiting = ledger.pocket && (pocket || ledger.pocket_found);
        let durable = wants
            .judged
            .iter()
            .all(|judged| judged.part.ordinal <= recorded);
        let at_rest = matches!(self.sort, Sort::Returning | Sort::OverNest | Sort::Opening);
        empty && !waiting && durable && at_rest && self.feed_rests()
    }

    /// Every part stands where it may wait.
    pub(super) fn is_at_rest(&self) -> bool {
        let nest = matches!(self.clamp, Clamp::Empty | Clamp::Judged);
        let full = matches!(self.sort, Sort::OverBin(..)) && !self.dark.is_empty();
        let sort = matches!(self.sort, Sort::OverNest | Sort::AtPart) || full;
        nest && sort
            && self.feed_rests()
            && self.ledger.falling.is_none()
            && self.mechanism.moving().next().is_none()
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
