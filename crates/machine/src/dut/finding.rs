//! Findings of every kind as data: results of a test that are not figures.

use super::characteristic::Characteristic;
use super::verdict::Bin;
use super::{Kind, em_relay, resistor, ssr, thermostat};
use crate::gauge::Side;

/// Constant data of a finding.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// Code in rows and exports.
    pub code: &'static str,
    /// Bin of a bad part; `None` for a part that cannot be judged.
    pub bin: Option<Bin>,
    /// Characteristic and side of the limit that the finding proves exceeded, if it proves one.
    pub proves: Option<(Characteristic, Side)>,
}

impl Entry {
    /// Returns the entry of a finding that proves the part bad.
    pub const fn fail(code: &'static str, bin: Bin) -> Self {
        Self {
            bin: Some(bin),
            ..Self::void(code)
        }
    }

    /// Returns the entry of a finding that leaves the part unjudged.
    pub const fn void(code: &'static str) -> Self {
        Self {
            code,
            bin: None,
            proves: None,
        }
    }

    /// Adds the characteristic whose limit the finding proves exceeded, and the side.
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
    /// Finding of a relay test.
    EmRelay(em_relay::Finding),
    /// Finding of a resistor test.
    Resistor(resistor::Finding),
    /// Finding of the test of a solid-state relay.
    Ssr(ssr::Finding),
    /// Finding of a test of temperature relays.
    Thermostat(thermostat::Finding),
}

impl Finding {
    /// Every finding of every kind.
    pub fn all() -> impl Iterator<Item = Self> {
        Kind::ALL.into_iter().flat_map(Kind::findings)
    }

    /// Returns the code of the finding and its consequence for the part.
    pub fn entry(self) -> Entry {
        match self {
            Self::EmRelay(finding) => finding.entry(),
            Self::Resistor(finding) => finding.entry(),
            Self::Ssr(finding) => finding.entry(),
            Self::Thermostat(finding) => finding.entry(),
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

impl From<thermostat::Finding> for Finding {
    fn from(finding: thermostat::Finding) -> Self {
        Self::Thermostat(finding)
    }
}

impl From<ssr::Finding> for Finding {
    fn from(finding: ssr::Finding) -> Self {
        Self::Ssr(finding)
    }
}
