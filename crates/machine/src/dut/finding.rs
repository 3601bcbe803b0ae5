//! Findings of every kind: what a test finds beside figures, as data.

use super::characteristic::Characteristic;
use super::verdict::Bin;
use super::{Kind, em_relay, resistor};
use crate::gauge::Side;

/// What is fixed about a finding.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// Code in rows and exports.
    pub code: &'static str,
    /// Bin of a bad part; none for a part that cannot be judged.
    pub bin: Option<Bin>,
    /// Characteristic and side of the limit that it proves exceeded, if it does.
    pub proves: Option<(Characteristic, Side)>,
}

impl Entry {
    /// The part is bad.
    pub const fn fail(code: &'static str, bin: Bin) -> Self {
        Self {
            bin: Some(bin),
            ..Self::void(code)
        }
    }

    /// The part cannot be judged.
    pub const fn void(code: &'static str) -> Self {
        Self {
            code,
            bin: None,
            proves: None,
        }
    }

    /// The part is bad, and its value lies beyond its limit on this side.
    pub fn proves(self, characteristic: impl Into<Characteristic>, side: Side) -> Self {
        Self {
            proves: Some((characteristic.into(), side)),
            ..self
        }
    }
}

/// One finding of a test, by kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Finding {
    /// Of a relay test.
    EmRelay(em_relay::Finding),
    /// Of a resistor test.
    Resistor(resistor::Finding),
}

impl Finding {
    /// Every finding of every kind.
    pub fn all() -> impl Iterator<Item = Self> {
        Kind::ALL.into_iter().flat_map(Kind::findings)
    }

    /// Returns what is fixed about it.
    pub fn entry(self) -> Entry {
        match self {
            Self::EmRelay(finding) => finding.entry(),
            Self::Resistor(finding) => finding.entry(),
        }
    }
}

impl From<em_relay::Finding> for Finding {
    fn from(finding: em_relay::Finding) -> Self {
        Self::EmRelay(finding)
    }
}

impl From<resistor::Finding> for Finding {
    fn from(finding: resistor::Finding) -> Self {
        Self::Resistor(finding)
    }
}
