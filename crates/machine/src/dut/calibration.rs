//! What the instruments of a rig were found to do, for any kind: dates and factors.

use super::em_relay;
use crate::gauge::factor::Named;
use crate::rig::supply::SupplyRange;
use serde::{Deserialize, Serialize};

/// Factors of a kind, as the history keeps them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Calibration {
    /// Of the coil board.
    EmRelay(em_relay::Calibration),
}

impl Calibration {
    /// True when it measures everything that the kind needs, reference parts included.
    pub fn is_complete(&self) -> bool {
        match self {
            Self::EmRelay(relay) => relay.overshoots.is_some(),
        }
    }

    /// When the factors were found, microseconds since 1970 UTC.
    pub fn made_at_us(&self) -> i64 {
        match self {
            Self::EmRelay(relay) => relay.made_at_us,
        }
    }

    /// When they may no longer be used.
    pub fn due_at_us(&self) -> i64 {
        match self {
            Self::EmRelay(relay) => relay.due_at_us,
        }
    }

    /// Made on a simulated rig.
    pub fn is_simulated(&self) -> bool {
        match self {
            Self::EmRelay(relay) => relay.simulated,
        }
    }

    /// Nominal voltage of the parts it holds for, V.
    pub fn nominal_v(&self) -> f64 {
        match self {
            Self::EmRelay(relay) => relay.nominal_v,
        }
    }

    /// True when it holds with the supply in this range.
    pub fn holds_in(&self, range: &SupplyRange) -> bool {
        match self {
            Self::EmRelay(relay) => relay.range_factor == range.factor,
        }
    }

    /// Every factor that was measured, with its name and unit.
    pub fn factors(&self) -> Vec<Named> {
        match self {
            Self::EmRelay(relay) => relay.factors(),
        }
    }
}
