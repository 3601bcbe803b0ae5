//! Alarms about parts: not there, not alone, not known, not where they were let go.

use super::{Alarm, AlarmCode};
use crate::handling::Place;
use crate::rig::bin::Bin;

impl Alarm {
    fn case(self, case: &'static str) -> Self {
        self.with("case", case)
    }

    /// The beam of a bin counted no part, or more than one.
    pub fn beam(bin: Bin, counted: u32) -> Self {
        let alarm = Self::from(AlarmCode::BinBeam)
            .with("bin", bin)
            .with("counted", counted);
        match counted {
            0 | 1 => alarm,
            _several => alarm.case("several"),
        }
    }

    /// The run ended before the beam of a bin had seen the part that was let go over it.
    pub fn beam_unread(bin: Bin) -> Self {
        Self::from(AlarmCode::BinBeam)
            .with("bin", bin)
            .case("unread")
    }

    /// A part that nobody knows lies where the machine looks for one.
    pub fn part_found(place: Place) -> Self {
        Self::from(AlarmCode::PartFound).with("place", place.name())
    }

    /// A part that was inside is nowhere.
    pub fn part_lost(place: Place) -> Self {
        Self::from(AlarmCode::PartLost).with("place", place.name())
    }

    /// A run before left a part inside, and it is nowhere.
    pub fn part_gone(place: Place) -> Self {
        Self::part_lost(place).case("gone")
    }

    /// A run before let a part go, and was cut off before a beam had confirmed it.
    pub fn fall_unseen(bin: Bin) -> Self {
        Self::from(AlarmCode::FallUnseen).with("bin", bin)
    }

    /// Open fingers that still hold a part.
    pub fn part_sticks() -> Self {
        Self::from(AlarmCode::PartStuck).case("between_fingers")
    }

    /// The beam of a bin stays dark.
    pub fn bin_full(bin: Bin) -> Self {
        Self::from(AlarmCode::BinFull).with("bin", bin)
    }
}
