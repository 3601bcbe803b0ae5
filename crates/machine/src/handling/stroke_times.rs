//! How long each motion takes, and so from when on one under way may arrive. The scan then polls its end sensors without
//! rest.

use super::moves::Move;
use units::Span;

/// Share of its mean time after which a motion may arrive: of strokes that scatter by 12 %, one in twenty arrives
/// earlier, and the scan notices it one rest later.
const SOON: f64 = 0.8;
/// Number of strokes that the mean follows.
const STROKES: u32 = 8;

/// Time of a motion.
#[derive(Debug)]
struct StrokeTime {
    of: Move,
    /// Number of strokes in the mean, up to [`STROKES`].
    n: u32,
    mean_s: f64,
}

/// Time of each motion made so far.
#[derive(Debug, Default)]
pub struct StrokeTimes(Vec<StrokeTime>);

impl StrokeTimes {
    /// Adds the time of a motion that has arrived.
    pub fn note(&mut self, movement: Move, took: Span) {
        let took_s = took.as_seconds();
        match self.0.iter_mut().find(|it| it.of == movement) {
            Some(it) => {
                it.n = (it.n + 1).min(STROKES);
                it.mean_s += (took_s - it.mean_s) / f64::from(it.n);
            }
            None => self.0.push(StrokeTime {
                of: movement,
                n: 1,
                mean_s: took_s,
            }),
        }
    }

    /// Returns true when a motion that began `ago` may arrive; one without a known time may arrive at any instant.
    pub fn may_arrive(&self, movement: Move, ago: Span) -> bool {
        let known = self.0.iter().find(|it| it.of == movement);
        known.is_none_or(|it| ago.as_seconds() >= SOON * it.mean_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motion_may_arrive_shortly_before_its_mean_time() {
        let mut times = StrokeTimes::default();
        assert!(times.may_arrive(Move::ProbesUp, Span::ms(0)), "unknown");
        for ms in [100, 100, 130] {
            times.note(Move::ProbesUp, Span::ms(ms));
        }
        // The mean is 110 ms.
        assert!(!times.may_arrive(Move::ProbesUp, Span::ms(87)));
        assert!(times.may_arrive(Move::ProbesUp, Span::ms(89)));
        assert!(times.may_arrive(Move::ProbesDown, Span::ms(0)), "another");
    }
}
