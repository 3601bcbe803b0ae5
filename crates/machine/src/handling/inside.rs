//! Parts left inside by an earlier run; a killed program leaves no record of its end.
//!
//! The next run looks for these parts during its first homing, with z up. A part left inside is in its old place or
//! farther on; if it is in neither, the run reports it missing. The run also reports a released part that no beam has
//! confirmed, unless the fingers still hold it. Only sensors decide where parts are; the earlier record never causes a
//! motion.

use super::ledger::Ledger;
use super::place::Place;
use super::recovery::SensedParts;
use super::trouble::Trouble;
use crate::rig::bin::Bin;

/// Places that held a part when the record was last written.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Inside {
    /// The pocket.
    pub pocket: bool,
    /// The nest.
    pub nest: bool,
    /// The gripper.
    pub gripper: bool,
    /// Bin of a released part that its beam has not confirmed.
    pub falling: Option<Bin>,
}

impl Inside {
    /// Returns the occupied places of the ledger.
    pub fn of(ledger: &Ledger) -> Self {
        Self {
            pocket: ledger.holds(Place::Pocket),
            nest: ledger.holds(Place::NEST),
            gripper: ledger.holds(Place::Gripper),
            falling: ledger.fall().map(|it| it.bin),
        }
    }

    /// Returns true for places that the sensors alone could not reconstruct later: a part is falling, or the next part
    /// has taken the place from which another was lifted. `recorded` are the places on record. A change of the pocket
    /// alone needs no record: its part cannot leave it for a full nest, and its sensor sees it.
    pub fn needs_record(self, recorded: Self) -> bool {
        let pocket = recorded.pocket;
        let has_changed = Self { pocket, ..self } != recorded;
        has_changed && (self.falling.is_some() || self.gripper && self.nest)
    }

    /// Returns a trouble for each part that is neither in its old place nor in one that it can have reached since.
    pub fn missing(self, seen: &SensedParts) -> Vec<Trouble> {
        let SensedParts {
            mut pocket,
            mut nest,
            mut gripper,
        } = *seen;
        let never_opened = self.falling.is_some() && !self.gripper && claim(&mut gripper);
        let fell = self.falling.filter(|_| !never_opened);
        let held = self.gripper && claim(&mut gripper);
        let stayed = self.nest && (claim(&mut nest) || claim(&mut gripper));
        let waits = self.pocket && (claim(&mut pocket) || claim(&mut nest) || claim(&mut gripper));
        // A part that slides off the fingers stays in the jaws.
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
        assert!(
            count(&seen_again) <= count(&left),
            "one sensor accounts for two parts"
        );
        fell.map(Trouble::FallUnseen)
            .into_iter()
            .chain(gone.map(|(place, _)| Trouble::Gone(place)))
            .collect()
    }
}

/// Returns true if the sensor shows a part, and clears `seen`: one signal accounts for one part only.
fn claim(seen: &mut bool) -> bool {
    std::mem::take(seen)
}
