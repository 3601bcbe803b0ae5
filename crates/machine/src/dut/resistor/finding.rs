//! Findings of a resistor test in addition to its result.

use super::parameter::{BIN, Parameter};
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
}

impl Finding {
    /// Every finding.
    pub const ALL: [Self; 3] = [Self::Open, Self::Short, Self::CurrentNotReadable];

    /// Returns code and consequence.
    pub fn entry(self) -> Entry {
        match self {
            Self::Open => {
                Entry::fail("resistor_open", BIN).proves(Parameter::Resistance, Side::High)
            }
            Self::Short => {
                Entry::fail("resistor_short", BIN).proves(Parameter::Resistance, Side::Low)
            }
            Self::CurrentNotReadable => Entry::void("resistor_current_not_readable"),
        }
    }
}
