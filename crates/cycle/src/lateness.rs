//! How late this computer is: from the deadline of a wait of the cycle to its end, and in passing bytes on.

use bus::{Histogram, Passage};
use machine::rig::wiring::Wiring;
use machine::view::{Bucket, LatenessView};
use units::{RigTime, Span};

/// Length of a window; [`Lateness::recent`] looks at the current window and the one before.
const WINDOW: Span = Span::ms(1_000);
/// Upper edge of the first bucket of a [`LatenessView`]; each further edge is twice the one before.
const FIRST_EDGE: Span = Span(64);
/// Number of buckets of a [`LatenessView`]; the last edge is 2.1 s.
const BUCKETS: u32 = 16;

/// Lateness of all waits of a run, and the worst of the last seconds.
#[derive(Debug, Clone, Default)]
pub struct Lateness {
    all: Histogram,
    sum: Span,
    worst: Span,
    window_began: RigTime,
    /// Worst lateness, of waits and bytes, in the current window and in the one before.
    windows: [Span; 2],
    passage: Passage,
}

impl Lateness {
    /// Returns a lateness that counts delays of bytes too, for [`Self::recent`] alone.
    pub fn with(passage: Passage) -> Self {
        Self {
            passage,
            ..Self::default()
        }
    }

    /// Counts a wait with the deadline `until` that ended at `now`; ignores one that ended before its deadline.
    pub fn count(&mut self, until: RigTime, now: RigTime) {
        self.note(self.passage.take_worst(), now);
        if now < until {
            return;
        }
        let late = now.since(until);
        self.all.add(late);
        self.sum += late;
        self.worst = self.worst.max(late);
        self.note(late, now);
    }

    fn note(&mut self, late: Span, now: RigTime) {
        let age = now.since(self.window_began);
        if age > WINDOW {
            let before = if age > WINDOW + WINDOW {
                Span(0)
            } else {
                self.windows[0]
            };
            self.windows = [Span(0), before];
            self.window_began = now;
        }
        self.windows[0] = self.windows[0].max(late);
    }

    /// Returns the worst lateness of the last one to two seconds.
    pub fn recent(&self) -> Span {
        self.windows[0].max(self.windows[1])
    }

    /// Returns [`Self::recent`] if it is long enough to explain a missing or late reply, else `None`.
    pub fn explaining(&self, wiring: &Wiring) -> Option<Span> {
        let recent = self.recent();
        (recent >= wiring.explaining_lateness()).then_some(recent)
    }

    /// Returns percentiles, worst values and buckets for screens and metrics.
    pub fn view(&self) -> LatenessView {
        let ms = |span: Span| span.as_seconds() * 1e3;
        // A percentile is the upper edge of its bucket, which may lie above the worst value.
        let at = |share| {
            ms(self
                .all
                .percentile(share)
                .unwrap_or_default()
                .min(self.worst))
        };
        LatenessView {
            waits: self.all.total(),
            p50_ms: at(0.5),
            p99_ms: at(0.99),
            p999_ms: at(0.999),
            worst_ms: ms(self.worst),
            recent_ms: ms(self.recent()),
            sum_ms: ms(self.sum),
            buckets: self.buckets(),
        }
    }

    fn buckets(&self) -> Vec<Bucket> {
        let mut below = 0;
        let edges = (0..BUCKETS).map(|octave| Span(FIRST_EDGE.0 << octave));
        let bucket = |edge: Span| {
            let up_to = self.all.count_up_to(edge);
            Bucket {
                up_to_ms: edge.as_seconds() * 1e3,
                count: up_to - std::mem::replace(&mut below, up_to),
            }
        };
        edges.map(bucket).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn late(times_us: &[(u64, u64)]) -> Lateness {
        let mut lateness = Lateness::default();
        for (until, now) in times_us {
            lateness.count(RigTime(*until), RigTime(*now));
        }
        lateness
    }

    #[test]
    fn a_wait_that_an_answer_ends_does_not_count() {
        assert_eq!(late(&[(1_000, 900)]).view().waits, 0);
    }

    #[test]
    fn the_view_holds_worst_percentiles_and_buckets() {
        let mut times = vec![(0, 100); 998];
        times.extend([(0, 3_000), (0, 40_000)]);
        let view = late(&times).view();
        assert_eq!((view.waits, view.worst_ms), (1_000, 40.0));
        assert!(view.p50_ms >= 0.1 && view.p50_ms < 0.13, "{}", view.p50_ms);
        assert!(view.p999_ms >= 3.0 && view.p999_ms < 3.7);
        let counts: Vec<u64> = view.buckets.iter().map(|it| it.count).collect();
        assert_eq!(counts[..11], [0, 998, 0, 0, 0, 0, 1, 0, 0, 0, 1]);
        assert_eq!(view.sum_ms, 142.8);
    }

    #[test]
    fn bytes_that_pass_late_count_as_recent() {
        let passage = Passage::late_by(Span::ms(40));
        let mut lateness = Lateness::with(passage);
        lateness.count(RigTime(1_000), RigTime(900));
        assert_eq!(lateness.recent(), Span::ms(40));
        assert_eq!(lateness.view().worst_ms, 0.0, "of waits alone");
    }

    #[test]
    fn the_recent_worst_is_forgotten_after_two_seconds() {
        let second = 1_000_000;
        let mut times = vec![(0, 40_000)];
        assert_eq!(late(&times).recent(), Span::ms(40));
        times.push((second + 60_000, second + 60_100));
        assert_eq!(late(&times).recent(), Span::ms(40));
        times.push((2 * second + 90_000, 2 * second + 90_100));
        assert_eq!(late(&times).recent(), Span(100));
        let pause = [(0, 40_000), (9 * second, 9 * second + 7)];
        assert_eq!(late(&pause).recent(), Span(7));
    }
}
