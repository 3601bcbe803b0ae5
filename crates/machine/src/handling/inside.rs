//! What the next run has to know of the parts inside: a program that is killed tells nobody what became of them.
//!
//! Whoever comes next looks at its first homing, z being up: each part left inside is where it was, or farther on, or
//! it is told. A part that was let go and that no beam had confirmed is told in any case, unless the fingers hold it
//! still. Sensors alone say where parts are; what is known from before moves nothing.

use super::ledger::Ledger;
use super::place::Place;
use super::recovery::Seen;
use super::trouble::Trouble;
use crate::rig::bin::Bin;

/// Places that held a part when they were written down last.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Inside {
    /// The pocket.
    pub pocket: bool,
    /// The nest.
    pub nest: bool,
    /// The gripper.
    pub gripper: bool,
    /// A part had been let go over this bin, and its beam had not confirmed it.
    pub falling: Option<Bin>,
}

impl Inside {
    /// As the ledger has it.
    pub fn of(ledger: &Ledger) -> Self {
        Self {
            pocket: ledger.holds(Place::Pocket),
            nest: ledger.holds(Place::NEST),
            gripper: ledger.holds(Place::Gripper),
            falling: ledger.fall().map(|it| it.bin),
        }
    }

    /// Hand-overs that sensors cannot tell of later: a part that falls, and one that was lifted when the next one has
    /// taken its place.
    pub fn is_hard_to_tell(self) -> bool {
        self.falling.is_some() || self.gripper && self.nest
    }

    /// Parts that are not seen where they were left, nor where they could have got to since.
    pub fn missing(self, seen: &Seen) -> Vec<Trouble> {
        let Seen {
            mut pocket,
            mut nest,
            mut gripper,
        } = *seen;
        let never_opened = self.falling.is_some() && !self.gripper && claim(&mut gripper);
        let fell = self.falling.filter(|_| !never_opened);
        let held = self.gripper && claim(&mut gripper);
        let stayed = self.nest && (claim(&mut nest) || claim(&mut gripper));
        let waits = self.pocket && (claim(&mut pocket) || claim(&mut nest) || claim(&mut gripper));
        // Jaws keep a part from which the fingers have slid off.
        let set_down = self.gripper && !held && claim(&mut nest);
        let gone = [
            (Place::Gripper, self.gripper && !held && !set_down),
            (Place::NEST, self.nest && !stayed),
            (Place::Pocket, self.pocket && !waits),
        ];
        let gone = gone.into_iter().filter(|(_, is_gone)| *is_gone);
        let left = [self.pocket, self.nest, self.gripper, self.falling.is_some()];
        let seen_again = [held, stayed, waits, set_down, never_opened];
        let count = |these: &[bool]| these.iter().filter(|it| **it).count();
        assert!(count(&seen_again) <= count(&left), "one part seen as two");
        fell.map(Trouble::FallUnseen)
            .into_iter()
            .chain(gone.map(|(place, _)| Trouble::Gone(place)))
            .collect()
    }
}

/// What is seen once accounts for one part.
fn claim(seen: &mut bool) -> bool {
    std::mem::take(seen)
}
