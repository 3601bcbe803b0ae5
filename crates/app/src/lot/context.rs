//! What a run was started with.

use crate::order::LotOrder;
use crate::source::RigSource;
use config::Plant;
use machine::dut::Recipe;
use machine::station::packml::State;
use std::sync::Arc;
use units::RigTime;

/// Lot of parts that were found inside of the rig between lots.
pub const FOUND: &str = "found in the rig";

/// What a run is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// Calibration when it is due, golden parts, then the parts of the lot.
    Lot,
    /// No lot: the machine rests in this state, and parts found inside are discharged as lot [`FOUND`].
    BetweenLots(State),
    /// References and golden parts only, whatever is stored; the history keeps no calibration of it.
    Calibration,
}

impl Purpose {
    /// The state in which the machine rests; none while a lot is under way.
    pub const fn rests_in(self) -> Option<State> {
        match self {
            Self::BetweenLots(state) => Some(state),
            Self::Lot | Self::Calibration => None,
        }
    }

    /// No lot is under way.
    pub const fn is_between_lots(self) -> bool {
        self.rests_in().is_some()
    }
}

/// What a run was started with.
#[derive(Debug, Clone, Copy)]
pub struct LotContext<'a> {
    /// Configuration.
    pub plant: &'a Plant,
    /// Recipe of the lot.
    pub recipe: &'a Arc<Recipe>,
    /// The lot.
    pub order: &'a LotOrder,
    /// The rig.
    pub source: &'a RigSource,
    /// What it is for.
    pub purpose: Purpose,
    /// Wall clock at rig time zero, microseconds since 1970 UTC.
    pub epoch_us: i64,
}

impl<'a> LotContext<'a> {
    /// Rig time begins where a live rig stands, else now.
    pub fn new(
        plant: &'a Plant,
        (order, recipe): (&'a LotOrder, &'a Arc<Recipe>),
        source: &'a RigSource,
        purpose: Purpose,
    ) -> Self {
        let now = || jiff::Timestamp::now().as_microsecond();
        #[cfg(feature = "sim")]
        let epoch_us = source.live().map_or_else(now, |live| live.epoch_us);
        #[cfg(not(feature = "sim"))]
        let epoch_us = now();
        Self {
            plant,
            recipe,
            order,
            source,
            purpose,
            epoch_us,
        }
    }

    /// The rig is simulated.
    pub fn is_simulated(&self) -> bool {
        self.source.is_simulated()
    }

    /// Rig time on the wall clock, microseconds since 1970 UTC.
    pub fn wall_us(&self, at: RigTime) -> i64 {
        self.epoch_us + i64::try_from(at.0).unwrap_or(i64::MAX)
    }
}
