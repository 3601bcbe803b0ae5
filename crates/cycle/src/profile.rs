//! Measures the wall time of each phase of the control cycle but `record`.

use std::time::Instant;

/// Wall time of each phase, summed over all turns, seconds; bus, history and simulator take the rest of the run.
#[derive(Debug, Clone, Copy, Default)]
pub struct Profile {
    /// Number of turns.
    pub turns: u64,
    /// Time of `scan`, which stores answers in the image.
    pub scan_s: f64,
    /// Time of `step`, which steps the station.
    pub step_s: f64,
    /// Time of `clear`, which passes motions through the guard.
    pub clear_s: f64,
    /// Time of `apply`, which turns outputs into commands.
    pub apply_s: f64,
    /// Time of `publish`, which builds the view for screens.
    pub publish_s: f64,
}

/// Adds the time since `from` to `total` and resets `from` to now.
pub(super) fn lap(total: &mut f64, from: &mut Instant) {
    let now = Instant::now();
    *total += now.duration_since(*from).as_secs_f64();
    *from = now;
}
