//! How long each motion takes, and so from when on one under way may arrive. The scan then polls its end sensors without
//! rest.

use super::moves::Move;
use units::Span;

/// Share of its mean time after which a motion may arrive: of strokes that scatter by 12 %, one in twenty arrives
/// earlier, and the scan notices it one rest later.
const SOON: f64 = 0.8;
/// Weight of the newest time in the mean.
const NEWEST: f64 = 0.125;

/// Mean time of each motion made so far, seconds.
#[derive(Debug, Default)]
pub struct StrokeTimes(Vec<(Move, f64)>);

impl StrokeTimes {
    /// Adds the time of a motion that has arrived.
    pub fn note(&mut self, movement: Move, took: Span) {
        let took_s = took.as_seconds();
        match self.0.iter_mut().find(|(known, _)| *known == movement) {
            Some((_, mean_s)) => *mean_s += NEWEST * (took_s - *mean_s),
            None => self.0.push((movement, took_s)),
        }
    }

    /// Returns true when a motion that began `ago` may arrive; one without a known time may arrive at any instant.
    pub fn may_arrive(&self, movement: Move, ago: Span) -> bool {
        let known = self.0.iter().find(|(known, _)| *known == movement);
        known.is_none_or(|(_, mean_s)| ago.as_seconds() >= SOON * mean_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motion_may_arrive_shortly_before_its_mean_time() {
        let mut times = StrokeTimes::default();
        assert!(times.may_arrive(Move::ProbesUp, Span::ms(0)), "unknown");
        for ms in [100, 100, 180] {
            times.note(Move::ProbesUp, Span::ms(ms));
        }
        // The mean is 110 ms.
        assert!(!times.may_arrive(Move::ProbesUp, Span::ms(87)));
        assert!(times.may_arrive(Move::ProbesUp, Span::ms(89)));
        assert!(times.may_arrive(Move::ProbesDown, Span::ms(0)), "another");
    }
}
