//! Measures the wall time of each phase of the control cycle.

use std::time::Instant;

/// Wall time of each phase, summed over all turns, seconds; bus, history and simulator take the rest of the run.
#[derive(Debug, Clone, Copy, Default)]
pub struct Profile {
    /// Number of turns.
    pub turns: u64,
    /// Storing answers in the image.
    pub scan_s: f64,
    /// Stepping the station.
    pub step_s: f64,
    /// Clearing motions by the guard.
    pub clear_s: f64,
    /// Turning outputs into commands.
    pub apply_s: f64,
    /// Building the view for screens.
    pub publish_s: f64,
}

/// Adds the time since `from` to `total` and resets `from` to now.
pub(super) fn lap(total: &mut f64, from: &mut Instant) {
    let now = Instant::now();
    *total += now.duration_since(*from).as_secs_f64();
    *from = now;
}
