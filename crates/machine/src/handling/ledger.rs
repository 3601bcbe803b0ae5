//! The part ledger: which part is in which place, from magazine or hand to a bin.
//!
//! A place hands its part over; it never copies one. `in = out + inside + lost` at every instant.
//!
//! An opening of the fingers that was driven may still not come: the module that should open them has tripped. So a
//! part that was let go is lost only when the fingers were seen empty; one that they still show is theirs again.

use super::inside::Inside;
use super::place::{NestId, Place};
use crate::rig::bin::Bin;
use std::collections::BTreeMap;
use units::{RigTime, Second};

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

/// How the part in [`Place::Falling`] falls; it is on its way down once it [has left](Self::has_left) the fingers.
#[derive(Debug, Clone, PartialEq)]
pub struct Fall {
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

/// What a place holds.
#[derive(Debug, Clone)]
enum Held {
    /// A part without a number yet; `found`: it does not belong to this run.
    Unnumbered { found: bool },
    /// A part with its numbers.
    Numbered(Part),
}

/// Places and counts.
#[derive(Debug, Clone, Default)]
pub struct Ledger {
    places: BTreeMap<Place, Held>,
    /// There while a part is in [`Place::Falling`].
    fall: Option<Fall>,
    /// Parts that came into the pocket or a socket.
    pub came_in: u64,
    /// Parts that a beam confirmed, or a person took out.
    pub went_out: u64,
    /// Parts that are declared lost by an alarm.
    pub lost: u64,
    /// Parts that belong to no run; they are part of `came_in`.
    pub found: u64,
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

    /// Whether a part is there.
    pub fn holds(&self, place: Place) -> bool {
        self.places.contains_key(&place)
    }

    /// The part that is there; `None` as long as it has no number, too.
    pub fn part(&self, place: Place) -> Option<&Part> {
        match self.places.get(&place)? {
            Held::Numbered(part) => Some(part),
            Held::Unnumbered { .. } => None,
        }
    }

    /// The same, to write down what becomes of it.
    pub fn part_mut(&mut self, place: Place) -> Option<&mut Part> {
        match self.places.get_mut(&place)? {
            Held::Numbered(part) => Some(part),
            Held::Unnumbered { .. } => None,
        }
    }

    /// Every place that holds a part, with the part once it has a number.
    pub fn each(&self) -> impl Iterator<Item = (Place, Option<&Part>)> {
        self.places.keys().map(|place| (*place, self.part(*place)))
    }

    /// Parts that jaws or fingers hold.
    pub fn held_mut(&mut self) -> impl Iterator<Item = &mut Part> {
        let held = |place: &Place| match place {
            Place::Nest(_) | Place::Gripper => true,
            Place::Pocket | Place::Falling | Place::Socket(_) => false,
        };
        let places = self.places.iter_mut();
        places.filter_map(move |(place, it)| match it {
            Held::Numbered(part) => held(place).then_some(part),
            Held::Unnumbered { .. } => None,
        })
    }

    /// The part of the pocket does not belong to this run.
    pub fn is_pocket_found(&self) -> bool {
        match self.places.get(&Place::Pocket) {
            Some(Held::Unnumbered { found }) => *found,
            Some(Held::Numbered(_)) | None => false,
        }
    }

    /// How the part falls that was let go last, until its beam has seen it.
    pub fn fall(&self) -> Option<&Fall> {
        self.fall.as_ref()
    }

    /// The same, to write down what is seen of it.
    pub fn fall_mut(&mut self) -> Option<&mut Fall> {
        self.fall.as_mut()
    }

    /// Parts between magazine and beam.
    pub fn inside(&self) -> u64 {
        self.places.len() as u64
    }

    /// `in = out + inside + lost`.
    pub fn balances(&self) -> bool {
        self.came_in == self.went_out + self.inside() + self.lost
    }

    /// A part has come into the empty pocket.
    pub fn enter_pocket(&mut self) {
        self.came_in += 1;
        self.put(Place::Pocket, Held::Unnumbered { found: false });
    }

    /// The part of the pocket is now in the nest and gets its number; `golden` names a golden part.
    pub fn enter_nest(&mut self, nest: NestId, golden: Option<String>) {
        let found = self.is_pocket_found();
        assert!(
            !(found && golden.is_some()),
            "a found part is no golden one"
        );
        self.take(Place::Pocket);
        let part = self.number(golden, found.then(|| FOUND.to_owned()));
        self.put(Place::Nest(nest), Held::Numbered(part));
    }

    /// A person has put a part into an empty socket; `golden` names a golden part.
    pub fn fill_socket(&mut self, socket: u16, golden: Option<String>) {
        self.came_in += 1;
        let part = self.number(golden, None);
        self.put(Place::Socket(socket), Held::Numbered(part));
    }

    /// A person has taken the judged part out of a socket and put it into its bin.
    pub fn unload_socket(&mut self, socket: u16) -> Part {
        let Held::Numbered(part) = self.take(Place::Socket(socket)) else {
            panic!("a part without a number in socket {socket}");
        };
        assert!(part.bin.is_some(), "unloaded before it was judged");
        self.went_out += 1;
        self.check();
        part
    }

    /// A part that nobody knows is in the empty place.
    pub fn find(&mut self, place: Place) {
        self.came_in += 1;
        self.found += 1;
        let held = match place {
            Place::Pocket => Held::Unnumbered { found: true },
            Place::Nest(_) | Place::Gripper | Place::Falling | Place::Socket(_) => {
                Held::Numbered(self.number(None, Some(FOUND.to_owned())))
            }
        };
        self.put(place, held);
    }

    /// The part of a place, if there is one, is nowhere; true when there was one.
    pub fn lose(&mut self, place: Place) -> bool {
        let gone = self.places.remove(&place).is_some();
        self.lost += u64::from(gone);
        if place == Place::Falling {
            self.fall = None;
        }
        self.check();
        gone
    }

    /// The part of the nest is now in the gripper.
    pub fn lift(&mut self, nest: NestId) {
        self.hand_over(Place::Nest(nest), Place::Gripper);
    }

    /// The part of the gripper lies in the nest again.
    pub fn set_down(&mut self, nest: NestId) {
        self.hand_over(Place::Gripper, Place::Nest(nest));
    }

    /// The gripper has let its part go over `bin`; an empty one lets none fall.
    pub fn drop_over(&mut self, bin: Bin, since: RigTime, beam_before: u32) {
        assert!(self.fall.is_none(), "two parts on their way down");
        if !self.holds(Place::Gripper) {
            return;
        }
        self.fall = Some(Fall {
            bin,
            since,
            has_left: false,
            beam_before,
            seen: None,
        });
        self.hand_over(Place::Gripper, Place::Falling);
    }

    /// The part that was to fall is still in the fingers: it sticks to them, or they never opened.
    pub fn keep_hold(&mut self) {
        self.fall = None;
        self.hand_over(Place::Falling, Place::Gripper);
    }

    /// The beam saw the falling part, if there is one.
    pub fn land(&mut self) -> Option<Part> {
        if !self.holds(Place::Falling) {
            return None;
        }
        self.fall = None;
        let Held::Numbered(part) = self.take(Place::Falling) else {
            panic!("a part without a number was let go");
        };
        self.went_out += 1;
        self.check();
        Some(part)
    }

    /// Parts of the run's own that came in.
    pub fn own(&self) -> u64 {
        self.came_in - self.found
    }

    /// Parts of the lot that have entered a nest.
    pub fn lot_parts(&self) -> u64 {
        self.lot_numbered
    }

    fn number(&mut self, golden: Option<String>, interrupted: Option<String>) -> Part {
        self.numbered += 1;
        let kind = match golden {
            Some(serial) => Kind::Golden(serial),
            None => {
                self.lot_numbered += 1;
                Kind::Lot(self.lot_numbered)
            }
        };
        assert!(self.lot_numbered <= self.numbered, "numbers given twice");
        Part {
            kind,
            ordinal: self.numbered,
            bin: None,
            test: None,
            probed_at: None,
            interrupted,
        }
    }

    fn hand_over(&mut self, from: Place, to: Place) {
        let part = self.take(from);
        self.put(to, part);
    }

    fn take(&mut self, place: Place) -> Held {
        match self.places.remove(&place) {
            Some(part) => part,
            None => panic!("no part to take from the {}", place.name()),
        }
    }

    fn put(&mut self, place: Place, part: Held) {
        let before = self.places.insert(place, part);
        assert!(before.is_none(), "a second part in the {}", place.name());
        self.check();
    }

    fn check(&self) {
        assert!(self.balances(), "a part is in two places or in none");
        let falls = self.holds(Place::Falling);
        assert_eq!(falls, self.fall.is_some(), "a fall without its part");
    }
}
