//! Everything a run needs: configuration, recipe, order, rig and purpose.

use crate::order::LotOrder;
use crate::source::RigSource;
use config::Plant;
use machine::dut::Recipe;
use machine::dut::experiment::Experiment;
use machine::station::packml::State;
use std::sync::Arc;
use units::RigTime;

/// Name of the lot that takes the parts found inside the rig between lots.
pub const FOUND_LOT: &str = "found in the rig";

/// Purpose of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// To calibrate if no calibration is valid, to measure reference parts, then to test the parts of the lot.
    Lot,
    /// To control the machine between lots: the machine begins in this state, and discharges parts found inside as lot
    /// [`FOUND_LOT`].
    BetweenLots(State),
    /// To measure only the references on the interface board and the reference parts, even if a calibration is valid;
    /// the run itself stores no calibration in the history.
    Calibration,
    /// To measure properties of a rig with a rack, without parts.
    Experiment(Experiment),
}

impl Purpose {
    /// Returns the state in which the machine begins a run with the purpose [`Self::BetweenLots`]; `None` for any other
    /// purpose.
    pub const fn rest_state(self) -> Option<State> {
        match self {
            Self::BetweenLots(state) => Some(state),
            Self::Lot | Self::Calibration | Self::Experiment(_) => None,
        }
    }

    /// Returns the experiment of the run; `None` for a run with parts.
    pub const fn experiment(self) -> Option<Experiment> {
        match self {
            Self::Experiment(what) => Some(what),
            Self::Lot | Self::Calibration | Self::BetweenLots(_) => None,
        }
    }

    /// Returns true for a run between lots.
    pub const fn is_between_lots(self) -> bool {
        self.rest_state().is_some()
    }
}

/// Everything a run needs.
#[derive(Debug, Clone, Copy)]
pub struct LotContext<'a> {
    /// Configuration of the plant.
    pub plant: &'a Plant,
    /// Recipe of the lot.
    pub recipe: &'a Arc<Recipe>,
    /// Order of the lot.
    pub order: &'a LotOrder,
    /// Rig of the run.
    pub source: &'a RigSource,
    /// Purpose of the run.
    pub purpose: Purpose,
    /// Wall clock at rig time zero, microseconds since 1970 UTC.
    pub epoch_us: i64,
}

impl<'a> LotContext<'a> {
    /// Creates the context; rig time zero is the epoch of a live rig, or now on any other rig.
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

    /// Returns true on a simulated rig.
    pub fn is_simulated(&self) -> bool {
        self.source.is_simulated()
    }

    /// Converts rig time to microseconds since 1970 UTC.
    pub fn wall_us(&self, at: RigTime) -> i64 {
        self.epoch_us + i64::try_from(at.0).unwrap_or(i64::MAX)
    }
}
