//! Findings of a relay test in addition to its results: the part is bad, or the test cannot judge it.

use super::threshold::Direction;
use super::{Parameter, bins};
use crate::dut::finding::Entry;
use crate::dut::reason::Reason;
use crate::gauge::Side;

/// Side of the changeover contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Contact {
    /// Normally open.
    No,
    /// Normally closed.
    Nc,
}

/// A finding; [`Finding::with`] adds the figure or the pin that its text names.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Finding {
    /// No current through the coil.
    CoilOpen,
    /// The coil draws more than the current channel can read.
    CoilCurrentOverRange,
    /// NO is closed without drive.
    NoClosedAtRest,
    /// NC is open without drive.
    NcOpenAtRest,
    /// NC stays closed at nominal voltage.
    NcDoesNotOpen,
    /// NO stays open at nominal voltage until the longest wait ends.
    NoDoesNotMake,
    /// NO makes only after the longest wait.
    OperatesTooLate,
    /// NC does not make within the longest wait after switch-off.
    ReleasesTooLate,
    /// The coarse ramp ends below the operate threshold.
    AboveCoarseRamp,
    /// The drop of a contact is over range at the full current of the source.
    ContactOverRange(Contact),
    /// The drop of a contact is over range, and the source cannot drive its current (compliance).
    ContactOpen(Contact),
    /// COM alone has no Kelvin contact: the part is misoriented, or the COM probe is dirty.
    Misoriented,
    /// One pin has no Kelvin contact; detail: its name.
    PinOpen,
    /// Several pins have no Kelvin contact; detail: their names.
    PinsOpen,
    /// The hard-wired chain of the raised probes is open.
    ProbeChainOpen,
    /// The board is in another supply range than the one selected; detail: both.
    OtherSupplyRange,
    /// No reading of the interface board.
    BoardNotRead,
    /// A scan lacks voltage or current.
    CoilNotRead,
    /// The reading of the coil voltage is not usable.
    CoilVoltageNotReadable,
    /// The coil voltage at the pre-bias is too low; detail: the voltage.
    CoilSupplyLow,
    /// Coil current flows after the drive is off.
    CoilCurrentRemains,
    /// The reading of the track temperature is not usable.
    TrackNotReadable,
    /// The reading of a contact drop is not usable.
    DropNotReadable(Contact),
    /// No zero reading to subtract from the NC drop: only in rows of earlier versions.
    DropWithoutZero,
    /// A contact resistance below any real one; detail: the figure.
    ContactImplausible(Contact),
    /// Fewer than two readings of the gated counters.
    GatesNotRead,
    /// Counts outside the range of any relay; detail: both counts.
    GatesImplausible,
    /// NO is closed after a coarse ramp, although the board detected no make while its window was open.
    MadeOutsideWindow,
    /// Every fine ramp missed the event; detail: number of ramps.
    ThresholdNotFound(Direction),
    /// A search by levels ended without an interval that contains the threshold.
    SearchWithoutThreshold(Direction),
}

impl Finding {
    /// Every finding, in the order of the enum.
    pub const ALL: [Self; 36] = [
        Self::CoilOpen,
        Self::CoilCurrentOverRange,
        Self::NoClosedAtRest,
        Self::NcOpenAtRest,
        Self::NcDoesNotOpen,
        Self::NoDoesNotMake,
        Self::OperatesTooLate,
        Self::ReleasesTooLate,
        Self::AboveCoarseRamp,
        Self::ContactOverRange(Contact::No),
        Self::ContactOverRange(Contact::Nc),
        Self::ContactOpen(Contact::No),
        Self::ContactOpen(Contact::Nc),
        Self::Misoriented,
        Self::PinOpen,
        Self::PinsOpen,
        Self::ProbeChainOpen,
        Self::OtherSupplyRange,
        Self::BoardNotRead,
        Self::CoilNotRead,
        Self::CoilVoltageNotReadable,
        Self::CoilSupplyLow,
        Self::CoilCurrentRemains,
        Self::TrackNotReadable,
        Self::DropNotReadable(Contact::No),
        Self::DropNotReadable(Contact::Nc),
        Self::DropWithoutZero,
        Self::ContactImplausible(Contact::No),
        Self::ContactImplausible(Contact::Nc),
        Self::GatesNotRead,
        Self::GatesImplausible,
        Self::MadeOutsideWindow,
        Self::ThresholdNotFound(Direction::Rising),
        Self::ThresholdNotFound(Direction::Falling),
        Self::SearchWithoutThreshold(Direction::Rising),
        Self::SearchWithoutThreshold(Direction::Falling),
    ];

    /// Returns the code of the finding and its consequence for the part.
    pub fn entry(self) -> Entry {
        use Contact::{Nc, No};
        use Direction::{Falling, Rising};
        match self {
            Self::CoilOpen => Entry::fail("coil_open", bins::COIL),
            Self::CoilCurrentOverRange => Entry::fail("coil_current_over_range", bins::COIL)
                .proves(Parameter::CoilResistance, Side::Low),
            Self::NoClosedAtRest => Entry::fail("no_closed_at_rest", bins::CONTACT),
            Self::NcOpenAtRest => Entry::fail("nc_open_at_rest", bins::CONTACT),
            Self::NcDoesNotOpen => Entry::fail("nc_does_not_open", bins::CONTACT),
            Self::NoDoesNotMake => Entry::fail("no_does_not_make", bins::CONTACT),
            Self::OperatesTooLate => Entry::fail("operates_too_late", bins::TIME)
                .proves(Parameter::OperateTime, Side::High),
            Self::ReleasesTooLate => Entry::fail("releases_too_late", bins::TIME)
                .proves(Parameter::ReleaseTime, Side::High),
            Self::AboveCoarseRamp => Entry::fail("above_coarse_ramp", bins::VOLTAGE)
                .proves(Parameter::OperateVoltage, Side::High),
            Self::ContactOverRange(No) => Entry::fail("no_contact_over_range", bins::CONTACT),
            Self::ContactOverRange(Nc) => Entry::fail("nc_contact_over_range", bins::CONTACT),
            Self::ContactOpen(No) => Entry::fail("no_contact_open", bins::CONTACT),
            Self::ContactOpen(Nc) => Entry::fail("nc_contact_open", bins::CONTACT),
            Self::Misoriented => Entry::void("misoriented"),
            Self::PinOpen => Entry::void("pin_open"),
            Self::PinsOpen => Entry::void("pins_open"),
            Self::ProbeChainOpen => Entry::void("probe_chain_open"),
            Self::OtherSupplyRange => Entry::void("other_supply_range"),
            Self::BoardNotRead => Entry::void("board_not_read"),
            Self::CoilNotRead => Entry::void("coil_not_read"),
            Self::CoilVoltageNotReadable => Entry::void("coil_voltage_not_readable"),
            Self::CoilSupplyLow => Entry::void("coil_supply_low"),
            Self::CoilCurrentRemains => Entry::void("coil_current_remains"),
            Self::TrackNotReadable => Entry::void("track_not_readable"),
            Self::DropNotReadable(No) => Entry::void("no_drop_not_readable"),
            Self::DropNotReadable(Nc) => Entry::void("nc_drop_not_readable"),
            Self::DropWithoutZero => Entry::void("nc_drop_without_zero"),
            Self::ContactImplausible(No) => Entry::void("no_contact_implausible"),
            Self::ContactImplausible(Nc) => Entry::void("nc_contact_implausible"),
            Self::GatesNotRead => Entry::void("gates_not_read"),
            Self::GatesImplausible => Entry::void("gates_implausible"),
            Self::MadeOutsideWindow => Entry::void("made_outside_window"),
            Self::ThresholdNotFound(Rising) => Entry::void("operate_threshold_not_found"),
            Self::ThresholdNotFound(Falling) => Entry::void("release_threshold_not_found"),
            Self::SearchWithoutThreshold(Rising) => Entry::void("operate_search_failed"),
            Self::SearchWithoutThreshold(Falling) => Entry::void("release_search_failed"),
        }
    }

    /// Returns the reason with the figure or the pins that its text names.
    pub fn with(self, detail: impl Into<String>) -> Reason {
        Reason {
            detail: detail.into(),
            ..self.into()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_finding_has_a_code_of_its_own() {
        let codes: BTreeSet<_> = Finding::ALL.map(|it| it.entry().code).into();
        assert_eq!(codes.len(), Finding::ALL.len());
    }
}
