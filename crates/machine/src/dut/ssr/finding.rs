//! Findings of the test of a solid-state relay, in addition to its results.

use super::bins;
use super::parameter::Parameter;
use crate::dut::Reason;
use crate::dut::finding::{Entry, Finding as AnyFinding};
use crate::dut::reason::Code;
use crate::gauge::Side;

/// Why a part fails, or why it could not be judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Finding {
    /// A force probe and its sense probe touch no common pin; detail: the pins.
    PinOpen,
    /// The probes are not up.
    ProbeChainOpen,
    /// The LED conducts between the pins of the output: the part lies turned in the nest.
    Turned,
    /// The output is shorted, or conducts below 1 kohm.
    Shorted,
    /// No current flows into the control input.
    InputOpen,
    /// The current into the control input is at its limit.
    InputShorted,
    /// The reversed control input conducts up to the limit of the current.
    InputConductsReversed,
    /// The leakage at the rated voltage is at the limit of the current.
    Leaks,
    /// The leakage after conduction is at the limit of the current.
    LeaksHot,
    /// The output conducts at the voltage at which it must block.
    ConductsBelowTurnOff,
    /// The output conducts without control after it has conducted once.
    StuckOn,
    /// The output does not conduct at the nominal control voltage.
    NeverOn,
    /// The output does not conduct at the voltage at which it must conduct.
    BlocksAboveTurnOn,
    /// The output does not conduct before the pulse ends.
    TurnsOnTooLate,
    /// The output conducts to the end of the record.
    TurnsOffTooLate,
    /// The drop of the conducting output is at the limit of the voltage.
    DropTooHigh,
    /// The record of the digitizer holds no control pulse, or no whole one.
    PulseNotRecorded,
    /// One polarity of the output does not conduct.
    HalfWave,
    /// The drop of the conducting AC output exceeds the range of its channel.
    PeakDropTooHigh,
    /// The mirror contacts do not show the position to which a contactor was switched; detail: the point.
    Contactor,
    /// The voltage of the AC source, or that of the line at the output, is not the one that was set.
    WrongMains,
    /// The line brings neither voltage nor current to the output: fuse, load or output of the source.
    LineDead,
    /// The loop brings neither voltage nor current to the output: fuse, contactor, load, wire or output of the source.
    LoopDead,
    /// The socket is shorted without a part's output.
    SocketShorted,
    /// The first test of the part has failed it, the second one has passed it.
    Unsteady,
    /// Readings of the part contradict each other: a connection broke or closed for a moment.
    Contradictory,
    /// A reference of the fixture reads more than a tenth off its value.
    WrongReference,
    /// An instrument has delivered other values than its programs return; detail: the instrument.
    NotDelivered,
}

impl Finding {
    /// Every finding.
    pub const ALL: [Self; 28] = [
        Self::PinOpen,
        Self::ProbeChainOpen,
        Self::Turned,
        Self::Shorted,
        Self::InputOpen,
        Self::InputShorted,
        Self::InputConductsReversed,
        Self::Leaks,
        Self::LeaksHot,
        Self::ConductsBelowTurnOff,
        Self::StuckOn,
        Self::NeverOn,
        Self::BlocksAboveTurnOn,
        Self::TurnsOnTooLate,
        Self::TurnsOffTooLate,
        Self::DropTooHigh,
        Self::PulseNotRecorded,
        Self::HalfWave,
        Self::PeakDropTooHigh,
        Self::Contactor,
        Self::WrongMains,
        Self::LineDead,
        Self::LoopDead,
        Self::SocketShorted,
        Self::Unsteady,
        Self::Contradictory,
        Self::WrongReference,
        Self::NotDelivered,
    ];

    /// Returns the code of the finding and its consequence for the part.
    pub fn entry(self) -> Entry {
        use Parameter as P;
        use Side::{High, Low};
        let input = |code| Entry::fail(code, bins::INPUT);
        let output = |code| Entry::fail(code, bins::OUTPUT);
        match self {
            Self::PinOpen => Entry::void("ssr_pin_open"),
            Self::ProbeChainOpen => Entry::void("ssr_probe_chain_open"),
            Self::Turned => Entry::void("ssr_turned"),
            Self::Shorted => output("ssr_shorted"),
            Self::InputOpen => input("ssr_input_open").proves(P::InputCurrent, Low),
            Self::InputShorted => input("ssr_input_shorted").proves(P::InputCurrent, High),
            Self::InputConductsReversed => {
                input("ssr_input_conducts_reversed").proves(P::ReverseCurrent, High)
            }
            Self::Leaks => Entry::fail("ssr_leaks", bins::LEAKAGE).proves(P::LeakageCold, High),
            Self::LeaksHot => {
                Entry::fail("ssr_leaks_hot", bins::LEAKAGE).proves(P::LeakageHot, High)
            }
            Self::ConductsBelowTurnOff => {
                input("ssr_conducts_below_turn_off").proves(P::TurnOffVoltage, Low)
            }
            Self::StuckOn => output("ssr_stuck_on"),
            Self::NeverOn => output("ssr_never_on"),
            Self::BlocksAboveTurnOn => {
                input("ssr_blocks_above_turn_on").proves(P::TurnOnVoltage, High)
            }
            Self::TurnsOnTooLate => {
                Entry::fail("ssr_turns_on_too_late", bins::TIME).proves(P::TurnOnTime, High)
            }
            Self::TurnsOffTooLate => {
                Entry::fail("ssr_turns_off_too_late", bins::TIME).proves(P::TurnOffTime, High)
            }
            Self::DropTooHigh => output("ssr_drop_too_high").proves(P::OnResistance, High),
            Self::PulseNotRecorded => Entry::void("ssr_pulse_not_recorded"),
            Self::HalfWave => output("ssr_half_wave").proves(P::HalfWave, High),
            Self::PeakDropTooHigh => output("ssr_peak_drop_too_high").proves(P::Drop, High),
            Self::Contactor => Entry::void("ssr_contactor"),
            Self::WrongMains => Entry::void("ssr_wrong_mains"),
            Self::LineDead => Entry::void("ssr_line_dead"),
            Self::LoopDead => Entry::void("ssr_loop_dead"),
            Self::SocketShorted => Entry::void("ssr_socket_shorted"),
            Self::Unsteady => Entry::void("ssr_unsteady"),
            Self::Contradictory => Entry::void("ssr_contradictory"),
            Self::WrongReference => Entry::void("ssr_wrong_reference"),
            Self::NotDelivered => Entry::void("ssr_not_delivered"),
        }
    }

    /// Returns the finding of a reason; `None` for a reason that is no finding about a solid-state relay.
    pub fn of(reason: &Reason) -> Option<Self> {
        match reason.code {
            Code::Finding(AnyFinding::Ssr(finding)) => Some(finding),
            _other => None,
        }
    }

    /// Returns true when a short in the socket, or an open circuit of the output, may look alike.
    pub const fn is_about_output(self) -> bool {
        !matches!(
            self,
            Self::InputOpen | Self::InputShorted | Self::InputConductsReversed
        )
    }

    /// Returns the reason of the finding, with `detail`: the names that the text shows.
    pub fn with(self, detail: impl Into<String>) -> Reason {
        Reason {
            detail: detail.into(),
            ..self.into()
        }
    }
}
