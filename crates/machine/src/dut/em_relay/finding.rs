//! What a test of a relay finds beside its figures: the part is bad, or could not be judged.

use super::threshold::Direction;
use super::{Parameter, bins};
use crate::dut::reason::{Code, Reason};
use crate::dut::verdict::Bin;
use crate::dut::words::Words;
use crate::gauge::Side;

/// A changeover contact has two sides.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Contact {
    /// Normally open.
    No,
    /// Normally closed.
    Nc,
}

/// One finding. Its text has a place for a figure or a pin where [`Finding::with`] adds one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Finding {
    /// No current through the coil.
    CoilOpen,
    /// The coil draws more than the current channel reads.
    CoilCurrentOverRange,
    /// NO is closed without drive.
    NoClosedAtRest,
    /// NC is open without drive.
    NcOpenAtRest,
    /// NC stays closed at nominal voltage.
    NcDoesNotOpen,
    /// NO stays open at nominal voltage.
    NoDoesNotMake,
    /// NO makes after the longest wait for it.
    OperatesTooLate,
    /// NC does not make within the longest wait after switch-off.
    ReleasesTooLate,
    /// The coarse ramp ends below the operate threshold.
    AboveCoarseRamp,
    /// The drop of a contact is over range although the source drives its current.
    ContactOverRange(Contact),
    /// The drop is over range and the source in compliance.
    ContactOpen(Contact),
    /// COM alone has no Kelvin contact: a misoriented part or a dirty COM probe.
    Misoriented,
    /// One pin has no Kelvin contact; detail: its name.
    PinOpen,
    /// Several pins have none; detail: their names.
    PinsOpen,
    /// The hard-wired chain of the raised probes is open.
    ProbeChainOpen,
    /// The interface board gave no inputs.
    BoardNotRead,
    /// A scan lacks voltage or current.
    CoilNotRead,
    /// The coil voltage is no number.
    CoilVoltageNotReadable,
    /// The supply gives too little at the pre-bias; detail: what it gives.
    CoilSupplyLow,
    /// Current flows after the drive was taken off.
    CoilCurrentRemains,
    /// The thermometer of the magazine track gave no number.
    TrackNotReadable,
    /// The drop of a contact gave no number.
    DropNotReadable(Contact),
    /// The NC drop has no reading without current to take off.
    DropWithoutZero,
    /// A resistance that no contact has; detail: the figure.
    ContactImplausible(Contact),
    /// The gated counters were not read twice.
    GatesNotRead,
    /// Counts that no relay causes; detail: both counts.
    GatesImplausible,
    /// NO is closed after a coarse ramp whose window saw no event.
    MadeOutsideWindow,
    /// Every fine ramp missed the event; detail: how many there were.
    ThresholdNotFound(Direction),
    /// A search by levels ended without an interval.
    SearchWithoutThreshold(Direction),
}

/// What is fixed about a finding.
struct Entry {
    code: &'static str,
    /// `{}` is the place of the detail.
    text: &'static str,
    /// Bin of a bad part; none where the part could not be judged.
    bin: Option<Bin>,
    /// What it proves of a limit.
    proves: Option<(Parameter, Side)>,
    /// What pages and paper say instead of the text.
    words: Option<Words>,
}

impl Entry {
    const fn fail(code: &'static str, text: &'static str, bin: Bin) -> Self {
        Self {
            code,
            text,
            bin: Some(bin),
            proves: None,
            words: None,
        }
    }

    const fn void(code: &'static str, text: &'static str) -> Self {
        Self {
            code,
            text,
            bin: None,
            proves: None,
            words: None,
        }
    }

    const fn proves(self, parameter: Parameter, side: Side) -> Self {
        Self {
            proves: Some((parameter, side)),
            ..self
        }
    }

    const fn said(self, en: &'static str, zh: &'static str) -> Self {
        Self {
            words: Some(Words { en, zh }),
            ..self
        }
    }

    /// In Chinese; in English as it stands in the text.
    const fn zh(self, zh: &'static str) -> Self {
        let en = self.text;
        self.said(en, zh)
    }
}

impl Finding {
    /// Every finding, in the order of the enum.
    pub const ALL: [Self; 35] = [
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

    const fn entry(self) -> Entry {
        use Contact::{Nc, No};
        use Direction::{Falling, Rising};
        match self {
            Self::CoilOpen => Entry::fail("coil_open", "coil open", bins::COIL).zh("线圈开路"),
            Self::CoilCurrentOverRange => Entry::fail(
                "coil_current_over_range",
                "coil_resistance_ohm low: current over range",
                bins::COIL,
            )
            .proves(Parameter::CoilResistance, Side::Low)
            .said("too low: current over range", "过低：电流超量程"),
            Self::NoClosedAtRest => Entry::fail(
                "no_closed_at_rest",
                "contact stuck: NO closed at rest",
                bins::CONTACT,
            )
            .zh("触点粘连：静止时常开触点闭合"),
            Self::NcOpenAtRest => Entry::fail(
                "nc_open_at_rest",
                "contact stuck: NC open at rest",
                bins::CONTACT,
            )
            .zh("触点故障：静止时常闭触点断开"),
            Self::NcDoesNotOpen => Entry::fail(
                "nc_does_not_open",
                "contact stuck: NC does not open at nominal voltage",
                bins::CONTACT,
            )
            .zh("触点粘连：额定电压下常闭触点不断开"),
            Self::NoDoesNotMake => Entry::fail(
                "no_does_not_make",
                "contact stuck: NO does not make at nominal voltage",
                bins::CONTACT,
            )
            .zh("触点故障：额定电压下常开触点不闭合"),
            Self::OperatesTooLate => Entry::fail(
                "operates_too_late",
                "operate_time_ms high: NO makes too late",
                bins::TIME,
            )
            .proves(Parameter::OperateTime, Side::High)
            .said("high: NO makes too late", "过高：常开触点闭合过迟"),
            Self::ReleasesTooLate => Entry::fail(
                "releases_too_late",
                "release_time_ms high: NC does not make after switch-off",
                bins::TIME,
            )
            .proves(Parameter::ReleaseTime, Side::High)
            .said(
                "high: NC does not make after switch-off",
                "过高：断电后常闭触点不闭合",
            ),
            Self::AboveCoarseRamp => Entry::fail(
                "above_coarse_ramp",
                "operate_voltage_v high: above the coarse ramp",
                bins::VOLTAGE,
            )
            .proves(Parameter::OperateVoltage, Side::High)
            .said("above the ramp", "超出扫描范围"),
            Self::ContactOverRange(No) => Entry::fail(
                "no_contact_over_range",
                "NO contact resistance over range",
                bins::CONTACT,
            ),
            Self::ContactOverRange(Nc) => Entry::fail(
                "nc_contact_over_range",
                "NC contact resistance over range",
                bins::CONTACT,
            ),
            Self::ContactOpen(No) => Entry::fail(
                "no_contact_open",
                "NO contact open or far too high",
                bins::CONTACT,
            ),
            Self::ContactOpen(Nc) => Entry::fail(
                "nc_contact_open",
                "NC contact open or far too high",
                bins::CONTACT,
            ),
            Self::Misoriented => {
                Entry::void("misoriented", "part turned or COM probe without contact")
                    .zh("零件放反或公共端探针未接触")
            }
            Self::PinOpen => Entry::void(
                "pin_open",
                "no Kelvin contact at {}: missing pin or dirty probe",
            ),
            Self::PinsOpen => Entry::void("pins_open", "no Kelvin contact at {}"),
            Self::ProbeChainOpen => Entry::void("probe_chain_open", "probe-up chain open"),
            Self::BoardNotRead => Entry::void("board_not_read", "interface board not read"),
            Self::CoilNotRead => {
                Entry::void("coil_not_read", "coil converter gave no voltage or current")
            }
            Self::CoilVoltageNotReadable => {
                Entry::void("coil_voltage_not_readable", "coil voltage not readable")
            }
            Self::CoilSupplyLow => {
                Entry::void("coil_supply_low", "coil supply gives {} at the pre-bias")
            }
            Self::CoilCurrentRemains => Entry::void(
                "coil_current_remains",
                "coil current not gone after the test",
            ),
            Self::TrackNotReadable => {
                Entry::void("track_not_readable", "track temperature not readable")
            }
            Self::DropNotReadable(No) => {
                Entry::void("no_drop_not_readable", "NO contact drop not readable")
            }
            Self::DropNotReadable(Nc) => {
                Entry::void("nc_drop_not_readable", "NC contact drop not readable")
            }
            Self::DropWithoutZero => {
                Entry::void("nc_drop_without_zero", "NC drop without its zero")
            }
            Self::ContactImplausible(No) => Entry::void(
                "no_contact_implausible",
                "NO contact reads {}: no contact does, check the 1 A source",
            ),
            Self::ContactImplausible(Nc) => Entry::void(
                "nc_contact_implausible",
                "NC contact reads {}: no contact does, check the 1 A source",
            ),
            Self::GatesNotRead => Entry::void("gates_not_read", "gate counters not read"),
            Self::GatesImplausible => {
                Entry::void("gates_implausible", "gate counters implausible: {}")
            }
            Self::MadeOutsideWindow => Entry::void(
                "made_outside_window",
                "coarse operate ramp: contact made outside the window",
            ),
            Self::ThresholdNotFound(Rising) => Entry::void(
                "operate_threshold_not_found",
                "operate threshold not found in {} fine ramps",
            ),
            Self::ThresholdNotFound(Falling) => Entry::void(
                "release_threshold_not_found",
                "release threshold not found in {} fine ramps",
            ),
            Self::SearchWithoutThreshold(Rising) => Entry::void(
                "operate_search_failed",
                "operate_voltage_v: no threshold between the ends of the search",
            ),
            Self::SearchWithoutThreshold(Falling) => Entry::void(
                "release_search_failed",
                "release_voltage_v: no threshold between the ends of the search",
            ),
        }
    }

    /// The finding with the figure or the pins that its text has a place for.
    pub fn with(self, detail: impl Into<String>) -> Reason {
        Reason {
            code: Code::EmRelay(self),
            side: self.entry().proves.map(|(_, side)| side),
            detail: detail.into(),
        }
    }

    /// Code in rows and exports.
    pub fn code(self) -> &'static str {
        self.entry().code
    }

    /// Bin of a bad part; none where the part could not be judged.
    pub fn bin(self) -> Option<Bin> {
        self.entry().bin
    }

    /// The characteristic whose limit it proves broken, if it does.
    pub fn proves(self) -> Option<Parameter> {
        self.entry().proves.map(|(parameter, _)| parameter)
    }

    /// What pages and paper say, after the name of the characteristic that it proves; none where they show the text.
    pub fn words(self) -> Option<Words> {
        self.entry().words
    }

    /// The finding with this code.
    pub fn from_code(code: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|it| it.code() == code)
    }

    /// The text of rows and messages.
    pub fn text(self, detail: &str) -> String {
        self.entry().text.replacen("{}", detail, 1)
    }

    /// Reads `text` back: the finding and its detail. For histories written before reasons had codes.
    pub fn from_text(text: &str) -> Option<(Self, String)> {
        Self::ALL.into_iter().find_map(|finding| {
            let detail = match finding.entry().text.split_once("{}") {
                Some((before, after)) => text.strip_prefix(before)?.strip_suffix(after)?,
                None if finding.entry().text == text => "",
                None => return None,
            };
            Some((finding, detail.to_owned()))
        })
    }
}

impl From<Finding> for Reason {
    fn from(finding: Finding) -> Self {
        finding.with("")
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_finding_has_a_code_and_text_of_its_own() {
        let codes: BTreeSet<_> = Finding::ALL.map(Finding::code).into();
        let texts: BTreeSet<_> = Finding::ALL.map(|it| it.entry().text).into();
        assert_eq!(
            (codes.len(), texts.len()),
            (Finding::ALL.len(), Finding::ALL.len())
        );
    }

    #[test]
    fn what_follows_the_name_of_a_parameter_has_words() {
        for finding in Finding::ALL {
            assert!(finding.proves().is_none() || finding.words().is_some());
        }
    }

    #[test]
    fn every_text_reads_back_as_its_finding() {
        for finding in Finding::ALL {
            let has_place = finding.entry().text.contains("{}");
            let detail = if has_place { "COM" } else { "" };
            let found = Finding::from_text(&finding.text(detail)).unwrap();
            assert_eq!(found, (finding, detail.to_owned()));
        }
        assert_eq!(Finding::from_text("module answers ?AA"), None);
    }
}
