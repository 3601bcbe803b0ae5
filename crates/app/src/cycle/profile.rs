//! Where the wall time of the control cycle goes.

use std::time::Instant;

/// Wall time of the phases of all turns, seconds; what is left of a run is bus, history and, where there
/// is one, the simulator.
#[derive(Debug, Clone, Copy, Default)]
pub struct Profile {
    /// Turns.
    pub turns: u64,
    /// Answers into the image.
    pub scan_s: f64,
    /// The station.
    pub step_s: f64,
    /// The guard.
    pub clear_s: f64,
    /// Outputs to commands.
    pub apply_s: f64,
    /// The view for screens.
    pub publish_s: f64,
}

/// Adds the time since `from` to `total` and begins anew.
pub(super) fn lap(total: &mut f64, from: &mut Instant) {
    let now = Instant::now();
    *total += now.duration_since(*from).as_secs_f64();
    *from = now;
}
