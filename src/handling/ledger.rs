//! The part ledger: every part is in exactly one place, from the pocket to a bin.
//!
//! A place hands its part over; it never copies one. `in = out + inside` at every instant.
//!
//! An opening of the fingers that was driven may still not come: the module that should open them has tripped. So a
//! part that was let go is lost only when the fingers were seen empty; one that they still show is theirs again.

use super::inside::Inside;
use crate::rig::bin::Bin;
use crate::units::{RigTime, Second};

/// Why a part that nobody knows is not tested.
const FOUND: &str = "found inside at the reset";

/// What a part is to the lot.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Kind {
    /// A golden part, by its serial.
    Golden(String),
    /// A part of the lot, by the order in which it entered the nest, from 1.
    Lot(u64),
}

/// A part inside the machine, from nest to bin.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Who it is.
    pub kind: Kind,
    /// Number over all parts of the run, golden parts included, from 1: order of the records.
    pub ordinal: u64,
    /// Where it belongs, once judged.
    pub bin: Option<Bin>,
    /// Time from probes up to verdict.
    pub test: Option<Second>,
    /// When its probes arrived.
    pub probed_at: Option<RigTime>,
    /// Why it is not tested (any more) but discharged to retest.
    pub interrupted: Option<String>,
}

/// A part that was let go, on its way down a chute once it [has left](Self::has_left) the fingers.
#[derive(Debug, Clone, PartialEq)]
pub struct Falling {
    /// Which part.
    pub part: Part,
    /// Bin it was let go over.
    pub bin: Bin,
    /// When the opening of the fingers was driven.
    pub since: RigTime,
    /// The fingers were seen empty since: until then they may hold it still.
    pub has_left: bool,
    /// Count of the bin's beam before.
    pub beam_before: u32,
    /// When the beam had first counted it.
    pub seen: Option<RigTime>,
}

/// Places and counts.
#[derive(Debug, Clone, Default)]
pub struct Ledger {
    /// A part in the pocket; it has no number before it enters the nest.
    pub pocket: bool,
    /// In the nest.
    pub nest: Option<Part>,
    /// In the gripper.
    pub gripper: Option<Part>,
    /// Between gripper and beam.
    pub falling: Option<Falling>,
    /// Parts that came into the pocket.
    pub came_in: u64,
    /// Parts that a beam confirmed.
    pub went_out: u64,
    /// Parts that are declared lost by an alarm.
    pub lost: u64,
    /// Parts that belong to no run; they are part of `came_in`.
    pub found: u64,
    /// The part in the pocket is one of them.
    pub pocket_found: bool,
    /// What a run before left inside, until somebody has looked.
    pub left: Inside,
    numbered: u64,
    lot_numbered: u64,
}

impl Ledger {
    /// Nothing is known but what a run before left inside.
    pub fn after(left: Inside) -> Self {
        Self {
            left,
            ..Self::default()
        }
    }

    /// What a run has to look for that begins now.
    pub fn to_look_for(&self) -> Inside {
        if self.left == Inside::default() {
            Inside::of(self)
        } else {
            self.left
        }
    }

    /// Parts between pocket and beam.
    pub fn inside(&self) -> u64 {
        u64::from(self.pocket)
            + u64::from(self.nest.is_some())
            + u64::from(self.gripper.is_some())
            + u64::from(self.falling.is_some())
    }

    /// `in = out + inside + lost`.
    pub fn balances(&self) -> bool {
        self.came_in == self.went_out + self.inside() + self.lost
    }

    /// A part has come into the empty pocket.
    pub fn enter_pocket(&mut self) {
        assert!(!self.pocket, "a part came into an occupied pocket");
        self.pocket = true;
        self.came_in += 1;
    }

    /// The part of the pocket is now in the nest and gets its number; `golden` names a golden part.
    pub fn enter_nest(&mut self, golden: Option<String>) {
        assert!(
            self.pocket && self.nest.is_none(),
            "pocket to nest without a part or a place"
        );
        self.pocket = false;
        let interrupted = std::mem::take(&mut self.pocket_found).then(|| FOUND.to_owned());
        self.nest = Some(self.numbered(golden, interrupted));
    }

    fn numbered(&mut self, golden: Option<String>, interrupted: Option<String>) -> Part {
        self.numbered += 1;
        let kind = match golden {
            Some(serial) => Kind::Golden(serial),
            None => {
                self.lot_numbered += 1;
                Kind::Lot(self.lot_numbered)
            }
        };
        Part {
            kind,
            ordinal: self.numbered,
            bin: None,
            test: None,
            probed_at: None,
            interrupted,
        }
    }

    /// A part that nobody knows is in the pocket.
    pub fn find_in_pocket(&mut self) {
        self.enter_pocket();
        self.pocket_found = true;
        self.found += 1;
    }

    /// A part that nobody knows is in the empty nest.
    pub fn find_in_nest(&mut self) {
        assert!(self.nest.is_none(), "found a second part in the nest");
        self.nest = Some(self.find());
    }

    /// A part that nobody knows is in the gripper.
    pub fn find_in_gripper(&mut self) {
        assert!(self.gripper.is_none(), "found a second part in the gripper");
        self.gripper = Some(self.find());
    }

    fn find(&mut self) -> Part {
        self.came_in += 1;
        self.found += 1;
        self.numbered(None, Some(FOUND.to_owned()))
    }

    /// The part of the gripper lies in the nest again.
    pub fn set_down(&mut self) {
        assert!(self.nest.is_none(), "set down on another part");
        self.nest = self.gripper.take();
    }

    /// The part of the pocket is nowhere.
    pub fn lose_pocket(&mut self) {
        self.lost += u64::from(std::mem::take(&mut self.pocket));
        self.pocket_found = false;
    }

    /// The part of the nest is nowhere.
    pub fn lose_nest(&mut self) -> Option<Part> {
        self.lost += u64::from(self.nest.is_some());
        self.nest.take()
    }

    /// The part of the gripper is nowhere.
    pub fn lose_gripper(&mut self) -> Option<Part> {
        self.lost += u64::from(self.gripper.is_some());
        self.gripper.take()
    }

    /// Parts of the run's own that came into the pocket.
    pub fn own(&self) -> u64 {
        self.came_in - self.found
    }

    /// The part of the nest is now in the gripper.
    pub fn lift(&mut self) {
        assert!(self.gripper.is_none(), "two parts in the gripper");
        self.gripper = self.nest.take();
        assert!(self.gripper.is_some(), "lifted from an empty nest");
    }

    /// The gripper has let its part go over `bin`.
    pub fn drop_over(&mut self, bin: Bin, since: RigTime, beam_before: u32) {
        assert!(self.falling.is_none(), "two parts on their way down");
        if let Some(part) = self.gripper.take() {
            self.falling = Some(Falling {
                part,
                bin,
                since,
                has_left: false,
                beam_before,
                seen: None,
            });
        }
    }

    /// The part that was to fall is still in the fingers: it sticks to them, or they never opened.
    pub fn keep_hold(&mut self) {
        assert!(self.gripper.is_none(), "kept hold of a second part");
        self.gripper = self.falling.take().map(|falling| falling.part);
    }

    /// The beam saw the falling part.
    pub fn land(&mut self) -> Option<Falling> {
        let falling = self.falling.take()?;
        self.went_out += 1;
        Some(falling)
    }

    /// The part that was falling never reached its beam.
    pub fn lose_falling(&mut self) -> Option<Falling> {
        let falling = self.falling.take()?;
        self.lost += 1;
        Some(falling)
    }

    /// Parts of the lot that have entered the nest.
    pub fn lot_parts(&self) -> u64 {
        self.lot_numbered
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_is_in_exactly_one_place_from_pocket_to_bin() {
        let mut ledger = Ledger::default();
        ledger.enter_pocket();
        assert!(ledger.balances() && ledger.inside() == 1);
        ledger.enter_nest(None);
        assert!(ledger.balances() && ledger.inside() == 1);
        ledger.lift();
        ledger.drop_over(Bin::PASS, RigTime(0), 0);
        assert!(ledger.balances() && ledger.inside() == 1);
        let landed = ledger.land().expect("it was falling");
        assert_eq!(landed.part.kind, Kind::Lot(1));
        assert!(ledger.balances() && ledger.inside() == 0);
    }

    #[test]
    fn golden_parts_have_no_number_of_the_lot() {
        let mut ledger = Ledger::default();
        ledger.enter_pocket();
        ledger.enter_nest(Some("G-12-1".into()));
        ledger.lift();
        ledger.enter_pocket();
        ledger.enter_nest(None);
        assert_eq!(ledger.nest.map(|part| part.kind), Some(Kind::Lot(1)));
    }
}
