//! Measures the wall time of each phase of the control cycle but `record`, in one turn of seventeen: reading the
//! clock seven times takes as long as a short turn.

use std::time::Instant;

/// Wall time of each phase over all turns, seconds, estimated from one turn in seventeen; bus, history and simulator take
/// the rest of the run.
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

/// Number of turns for each measured turn; a prime, so that no kind of turn in a regular sequence escapes.
const TURNS: u64 = 17;

impl Profile {
    /// Counts a turn. Returns a stopwatch that runs if this turn is measured.
    pub(super) fn turn(&mut self) -> Stopwatch {
        self.turns += 1;
        let is_measured = self.turns % TURNS == TURNS / 2;
        Stopwatch(is_measured.then(Instant::now))
    }
}

/// Stopwatch over the phases of one turn.
pub(super) struct Stopwatch(Option<Instant>);

impl Stopwatch {
    /// Adds the time since the last call to `total`, for all turns that this one stands for.
    pub(super) fn lap(&mut self, total: &mut f64) {
        if let Some(from) = &mut self.0 {
            let now = Instant::now();
            *total += TURNS as f64 * now.duration_since(*from).as_secs_f64();
            *from = now;
        }
    }

    /// Leaves the time since the last call out.
    pub(super) fn skip(&mut self) {
        if let Some(from) = &mut self.0 {
            *from = Instant::now();
        }
    }
}
