//! A run on a stage: a study holds the simulated rig, which goes on living when the controller is gone.

use super::Controls;
use machine::dut::Calibration;
#[cfg(feature = "sim")]
use rigsim::SharedRig;

/// What a study brings to a run in place of what the run would find by itself.
#[derive(Debug, Clone)]
pub struct Stage {
    /// The rig behind the lines; rig time of the run begins where the rig stands.
    #[cfg(feature = "sim")]
    pub rig: SharedRig,
    /// Wall clock at rig time zero of the run, microseconds since 1970 UTC: the same rows for the same seed.
    pub epoch_us: i64,
    /// What the rig was calibrated with before; without it the run calibrates.
    pub calibration: Option<Calibration>,
}

impl Controls {
    /// Wall clock at rig time zero, microseconds since 1970 UTC.
    pub(super) fn epoch_us(&self) -> i64 {
        let now = || jiff::Timestamp::now().as_microsecond();
        self.stage.as_ref().map_or_else(now, |stage| stage.epoch_us)
    }

    /// A simulated rig whose time begins with this run: what an earlier one left inside was inside of another rig.
    pub(super) fn rig_is_new(&self) -> bool {
        #[cfg(feature = "sim")]
        let lived = self.stage.as_ref().is_some_and(|it| it.rig.now_us() > 0);
        #[cfg(not(feature = "sim"))]
        let lived = false;
        !lived
    }

    /// The rig of the stage.
    #[cfg(feature = "sim")]
    pub(super) fn staged_rig(&self) -> Option<SharedRig> {
        self.stage.as_ref().map(|stage| stage.rig.clone())
    }
}
