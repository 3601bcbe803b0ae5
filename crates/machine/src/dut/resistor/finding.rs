//! Findings of a resistor test in addition to its result.

use super::parameter::{BIN, Parameter};
use crate::dut::reason::{Code, Reason};
use crate::gauge::Side;
use crate::rig::bin::Bin;

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

    /// Returns the code in rows and exports.
    pub fn code(self) -> &'static str {
        match self {
            Self::Open => "resistor_open",
            Self::Short => "resistor_short",
            Self::CurrentNotReadable => "resistor_current_not_readable",
            Self::OtherSupplyRange => "resistor_other_supply_range",
        }
    }

    /// Returns the bin of a bad part; `None` for a part that cannot be judged.
    pub fn bin(self) -> Option<Bin> {
        self.side().map(|_| BIN)
    }

    /// Returns the characteristic whose limit the finding proves exceeded, if any.
    pub fn proves(self) -> Option<Parameter> {
        self.side().map(|_| Parameter::Resistance)
    }

    /// Returns the finding with this code.
    pub fn from_code(code: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|it| it.code() == code)
    }

    fn side(self) -> Option<Side> {
        match self {
            Self::Open => Some(Side::High),
            Self::Short => Some(Side::Low),
            Self::CurrentNotReadable | Self::OtherSupplyRange => None,
        }
    }
}

impl Finding {
    /// Returns the reason with the figure or the names that its text holds.
    pub fn with(self, detail: impl Into<String>) -> Reason {
        Reason {
            code: Code::Resistor(self),
            side: self.side(),
            detail: detail.into(),
        }
    }
}

impl From<Finding> for Reason {
    fn from(finding: Finding) -> Self {
        finding.with("")
    }
}
