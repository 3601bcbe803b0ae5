//! Findings of a resistor test in addition to its result.

use super::parameter::{BIN, Parameter};
use crate::dut::Reason;
use crate::dut::finding::Entry;
use crate::gauge::Side;

/// A finding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Finding {
    /// No current: the resistor, a pin or a probe is open.
    Open,
    /// The current exceeds the range of the channel.
    Short,
    /// The channel has no usable reading.
    CurrentNotReadable,
    /// The supply is in another range than the one selected; detail: both.
    OtherSupplyRange,
}

impl Finding {
    /// Every finding.
    pub const ALL: [Self; 4] = [
        Self::Open,
        Self::Short,
        Self::CurrentNotReadable,
        Self::OtherSupplyRange,
    ];

    /// Returns the code of the finding and its consequence for the part.
    pub fn entry(self) -> Entry {
        match self {
            Self::Open => {
                Entry::fail("resistor_open", BIN).proves(Parameter::Resistance, Side::High)
            }
            Self::Short => {
                Entry::fail("resistor_short", BIN).proves(Parameter::Resistance, Side::Low)
            }
            Self::CurrentNotReadable => Entry::void("resistor_current_not_readable"),
            Self::OtherSupplyRange => Entry::void("resistor_other_supply_range"),
        }
    }

    /// Returns the reason with `detail`, which completes its text with names.
    pub fn with(self, detail: impl Into<String>) -> Reason {
        Reason {
            detail: detail.into(),
            ..self.into()
        }
    }
}
