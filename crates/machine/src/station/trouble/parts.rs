//! Alarms about missing, double, unknown and stuck parts.

use super::{Alarm, AlarmCode};
use crate::handling::Place;
use crate::rig::bin::Bin;

impl Alarm {
    fn case(self, case: &'static str) -> Self {
        self.with("case", case)
    }

    /// Returns the alarm that the beam of a bin counted no part, or more than one.
    pub fn beam(bin: Bin, counted: u32) -> Self {
        let alarm = Self::from(AlarmCode::BinBeam)
            .with("bin", bin)
            .with("counted", counted);
        match counted {
            0 | 1 => alarm,
            _several => alarm.case("several"),
        }
    }

    /// Returns the alarm that the run ended before the beam of the bin had counted the released part.
    pub fn beam_unread(bin: Bin) -> Self {
        Self::from(AlarmCode::BinBeam)
            .with("bin", bin)
            .case("unread")
    }

    /// Returns the alarm that a sensor shows a part that the ledger does not have.
    pub fn part_found(place: Place) -> Self {
        Self::from(AlarmCode::PartFound).with("place", place.name())
    }

    /// Returns the alarm that no sensor shows a part that the ledger has.
    pub fn part_lost(place: Place) -> Self {
        Self::from(AlarmCode::PartLost).with("place", place.name())
    }

    /// Returns the alarm that no sensor shows a part that an earlier run left inside.
    pub fn part_gone(place: Place) -> Self {
        Self::part_lost(place).case("gone")
    }

    /// Returns the alarm that an earlier run ended after the release of a part, before the beam of the bin counted it.
    pub fn fall_unseen(bin: Bin) -> Self {
        Self::from(AlarmCode::FallUnseen).with("bin", bin)
    }

    /// Returns the alarm that a run ended before the parts with these scanned numbers came; each number has the name of
    /// the person who scanned it.
    pub fn scans_dropped(scans: &[(String, String)]) -> Self {
        let named = |(serial, who): &(String, String)| format!("{serial} ({who})");
        let serials: Vec<String> = scans.iter().map(named).collect();
        Self::from(AlarmCode::ScansDropped).with("serials", serials.join(", "))
    }

    /// Returns the alarm that a part sticks in the open gripper.
    pub fn part_sticks() -> Self {
        Self::from(AlarmCode::PartStuck).case("between_fingers")
    }

    /// Returns the alarm that the beam of a bin stays dark.
    pub fn bin_full(bin: Bin) -> Self {
        Self::from(AlarmCode::BinFull).with("bin", bin)
    }
}
