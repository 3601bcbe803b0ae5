//! The part ledger: the place of every part, from the magazine or an operator's hand to a bin.
//!
//! A part moves from place to place and is never copied. `in = out + inside + lost` holds at every instant.
//!
//! When the output module has tripped, the fingers may stay closed although their opening was commanded. So a released
//! part counts as lost only after the sensor shows empty fingers; a part that the sensor still shows is put back into
//! the fingers.

use super::inside::Inside;
use super::place::{NestId, Place};
use crate::dut::Reason;
use crate::dut::reason::SerialFault;
use crate::rig::bin::Bin;
use std::collections::BTreeMap;
use units::{RigTime, Second};

/// Reason why a part found inside is not tested.
const FOUND: &str = "found_inside";

/// Role of a part in the lot.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PartRole {
    /// A reference part, with its serial number.
    Reference(String),
    /// A part of the lot, by the order in which it entered the nest, from 1.
    Lot(u64),
}

/// A part inside the machine, from nest to bin.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Role and number of the part.
    pub role: PartRole,
    /// Running number over all parts of the run, reference parts included, from 1. The history publishes the number of
    /// the last part whose rows are on the disk.
    pub ordinal: u64,
    /// Bin of the part, after its verdict.
    pub bin: Option<Bin>,
    /// Time from the arrival of the probes at the part to the verdict.
    pub test: Option<Second>,
    /// Time at which the probes arrived at the part.
    pub probed_at: Option<RigTime>,
    /// Reason why the part goes to retest without a (complete) test.
    pub interrupted: Option<String>,
    /// Serial number of a part of the lot; `None` in a lot without them, and when no reading gives one.
    pub serial: Option<String>,
    /// What is wrong with the serial number, with the readings. Such a part goes to retest without a test.
    pub serial_fault: Option<(SerialFault, String)>,
    /// Batch and socket of a part that a person has put into a rack.
    pub tested_in: Option<BatchSocket>,
}

/// A socket of the rack in one batch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BatchSocket {
    /// Number of the batch in its run, from 1.
    pub batch: u64,
    /// Number of the socket.
    pub socket: u16,
}

impl Part {
    /// Returns why the part goes to retest without a complete test, if it does.
    pub fn why_untested(&self) -> Option<Reason> {
        let interrupted = self.interrupted.as_deref().map(Reason::interrupted);
        interrupted.or_else(|| {
            let (fault, read) = self.serial_fault.as_ref()?;
            Some(Reason::serial(*fault, read))
        })
    }

    /// Marks the part as interrupted; returns its reason, which is the earlier one if it was marked before.
    pub fn interrupt(&mut self, why: &str) -> String {
        let why = self.interrupted.get_or_insert_with(|| why.to_owned());
        why.clone()
    }
}

/// The fall of the part in [`Place::Falling`]; it begins when the part [has left](Self::has_left) the fingers.
#[derive(Debug, Clone, PartialEq)]
pub struct Fall {
    /// Bin under the fingers at the release.
    pub bin: Bin,
    /// Time at which the opening of the fingers was commanded.
    pub since: RigTime,
    /// True once the sensor has shown empty fingers; until then they may still hold the part.
    pub has_left: bool,
    /// Count of the bin's beam before the release.
    pub beam_before: u32,
    /// Time at which the beam first counted the part; `None` before.
    pub seen: Option<RigTime>,
}

/// Content of a place.
#[derive(Debug, Clone)]
enum Content {
    /// A part without a number yet; `found` is true when it does not belong to this run.
    Unnumbered { found: bool },
    /// A part with its numbers.
    Numbered(Part),
}

/// The part in each place, and the counts of parts.
#[derive(Debug, Clone, Default)]
pub struct Ledger {
    places: BTreeMap<Place, Content>,
    /// Present while a part is in [`Place::Falling`].
    fall: Option<Fall>,
    /// Number of parts that entered the pocket or a socket.
    pub came_in: u64,
    /// Number of parts that a beam confirmed or a person took out.
    pub went_out: u64,
    /// Number of parts that an alarm declared lost.
    pub lost: u64,
    /// Number of parts that do not belong to this run; `came_in` includes them.
    pub found: u64,
    /// Parts left by an earlier run, until homing has looked for them.
    pub left: Inside,
    numbered: u64,
    lot_numbered: u64,
}

impl Ledger {
    /// Makes a ledger that holds no part, and remembers the parts that an earlier run left inside.
    pub fn after(left: Inside) -> Self {
        Self {
            left,
            ..Self::default()
        }
    }

    /// Returns the parts that a new run must look for.
    pub fn parts_to_find(&self) -> Inside {
        if self.left == Inside::default() {
            Inside::of(self)
        } else {
            self.left
        }
    }

    /// Returns true when the place holds a part.
    pub fn holds(&self, place: Place) -> bool {
        self.places.contains_key(&place)
    }

    /// Returns the part in the place; `None` without a part or without its number.
    pub fn part(&self, place: Place) -> Option<&Part> {
        match self.places.get(&place)? {
            Content::Numbered(part) => Some(part),
            Content::Unnumbered { .. } => None,
        }
    }

    /// Returns the part in the place for changes; `None` without a part or without its number.
    pub fn part_mut(&mut self, place: Place) -> Option<&mut Part> {
        match self.places.get_mut(&place)? {
            Content::Numbered(part) => Some(part),
            Content::Unnumbered { .. } => None,
        }
    }

    /// Yields every occupied place, with the part once it has a number.
    pub fn each(&self) -> impl Iterator<Item = (Place, Option<&Part>)> {
        self.places.keys().map(|place| (*place, self.part(*place)))
    }

    /// Yields, for changes, the parts that an interruption leaves unfinished: those in jaws or fingers, and those in
    /// sockets before their verdict. A judged part in a socket keeps its verdict, because a person takes it out anyway.
    pub fn held_mut(&mut self) -> impl Iterator<Item = &mut Part> {
        let held = |place: &Place, part: &Part| match place {
            Place::Nest(_) | Place::Gripper => true,
            Place::Socket(_) => part.bin.is_none(),
            Place::Pocket | Place::Falling => false,
        };
        let places = self.places.iter_mut();
        places.filter_map(move |(place, it)| match it {
            Content::Numbered(part) => held(place, part).then_some(part),
            Content::Unnumbered { .. } => None,
        })
    }

    /// Returns true when the part in the pocket does not belong to this run.
    pub fn is_pocket_found(&self) -> bool {
        match self.places.get(&Place::Pocket) {
            Some(Content::Unnumbered { found }) => *found,
            Some(Content::Numbered(_)) | None => false,
        }
    }

    /// Returns the fall of the released part until its beam has counted the part, else `None`.
    pub fn fall(&self) -> Option<&Fall> {
        self.fall.as_ref()
    }

    /// Returns [`Self::fall`] for changes.
    pub fn fall_mut(&mut self) -> Option<&mut Fall> {
        self.fall.as_mut()
    }

    /// Returns the number of parts between magazine and beam.
    pub fn inside(&self) -> u64 {
        self.places.len() as u64
    }

    /// Returns true when `in = out + inside + lost`.
    pub fn balances(&self) -> bool {
        self.came_in == self.went_out + self.inside() + self.lost
    }

    /// Adds a part to the pocket, which must be empty.
    pub fn enter_pocket(&mut self) {
        self.came_in += 1;
        self.put(Place::Pocket, Content::Unnumbered { found: false });
    }

    /// Moves the part from the pocket to the nest and numbers it; `reference`: serial number, if it is a reference
    /// part.
    pub fn enter_nest(&mut self, nest: NestId, reference: Option<String>) {
        let found = self.is_pocket_found();
        assert!(
            !(found && reference.is_some()),
            "a found part cannot be a reference part"
        );
        self.take(Place::Pocket);
        let part = self.number(reference, found.then(|| FOUND.to_owned()));
        self.put(Place::Nest(nest), Content::Numbered(part));
    }

    /// Adds a part that a person put into an empty socket; `reference`: serial number, if it is a reference part.
    pub fn fill_socket(&mut self, at: BatchSocket, reference: Option<String>) {
        self.came_in += 1;
        let part = Part {
            tested_in: Some(at),
            ..self.number(reference, None)
        };
        self.put(Place::Socket(at.socket), Content::Numbered(part));
    }

    /// Removes the part that a person took out of a socket and put into its bin; panics unless the part is judged.
    pub fn unload_socket(&mut self, socket: u16) -> Part {
        let Content::Numbered(part) = self.take(Place::Socket(socket)) else {
            panic!("a part without a number in socket {socket}");
        };
        assert!(part.bin.is_some(), "unloaded before its verdict");
        self.went_out += 1;
        self.check();
        part
    }

    /// Adds a part of unknown origin to a place, which must be empty.
    pub fn find(&mut self, place: Place) {
        self.came_in += 1;
        self.found += 1;
        let held = match place {
            Place::Pocket => Content::Unnumbered { found: true },
            Place::Nest(_) | Place::Gripper | Place::Falling | Place::Socket(_) => {
                Content::Numbered(self.number(None, Some(FOUND.to_owned())))
            }
        };
        self.put(place, held);
    }

    /// Declares the part of a place lost; returns false for an empty place.
    pub fn lose(&mut self, place: Place) -> bool {
        let gone = self.places.remove(&place).is_some();
        self.lost += u64::from(gone);
        if place == Place::Falling {
            self.fall = None;
        }
        self.check();
        gone
    }

    /// Moves the part from the nest to the gripper.
    pub fn lift(&mut self, nest: NestId) {
        self.hand_over(Place::Nest(nest), Place::Gripper);
    }

    /// Moves the part from the gripper back to the nest.
    pub fn set_down(&mut self, nest: NestId) {
        self.hand_over(Place::Gripper, Place::Nest(nest));
    }

    /// Moves the gripper's part to [`Place::Falling`], over `bin`; does nothing for an empty gripper. Panics while
    /// another part falls.
    pub fn drop_over(&mut self, bin: Bin, since: RigTime, beam_before: u32) {
        assert!(self.fall.is_none(), "two parts fall at once");
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

    /// Moves the falling part back to the fingers, because it sticks to them or they never opened.
    pub fn return_to_gripper(&mut self) {
        self.fall = None;
        self.hand_over(Place::Falling, Place::Gripper);
    }

    /// Removes the falling part, if there is one, because its beam has counted it; the part is then out of the machine.
    pub fn land(&mut self) -> Option<Part> {
        if !self.holds(Place::Falling) {
            return None;
        }
        self.fall = None;
        let Content::Numbered(part) = self.take(Place::Falling) else {
            panic!("a part without a number was released");
        };
        self.went_out += 1;
        self.check();
        Some(part)
    }

    /// Returns the number of parts that entered and belong to this run.
    pub fn own_parts(&self) -> u64 {
        self.came_in - self.found
    }

    /// Returns the number of parts of the lot that have entered a nest.
    pub fn lot_parts(&self) -> u64 {
        self.lot_numbered
    }

    fn number(&mut self, reference: Option<String>, interrupted: Option<String>) -> Part {
        self.numbered += 1;
        let role = match reference {
            Some(serial) => PartRole::Reference(serial),
            None => {
                self.lot_numbered += 1;
                PartRole::Lot(self.lot_numbered)
            }
        };
        assert!(self.lot_numbered <= self.numbered, "numbers given twice");
        Part {
            role,
            ordinal: self.numbered,
            bin: None,
            test: None,
            probed_at: None,
            interrupted,
            serial: None,
            serial_fault: None,
            tested_in: None,
        }
    }

    fn hand_over(&mut self, from: Place, to: Place) {
        let part = self.take(from);
        self.put(to, part);
    }

    fn take(&mut self, place: Place) -> Content {
        match self.places.remove(&place) {
            Some(part) => part,
            None => panic!("no part to take from the {}", place.name()),
        }
    }

    fn put(&mut self, place: Place, part: Content) {
        let before = self.places.insert(place, part);
        assert!(before.is_none(), "a second part in the {}", place.name());
        self.check();
    }

    fn check(&self) {
        assert!(self.balances(), "a part is in two places or in none");
        let falls = self.holds(Place::Falling);
        assert_eq!(
            falls,
            self.fall.is_some(),
            "the fall and its part do not match"
        );
    }
}
