//! Intervals of time whose ends are fractions of whole numbers.

/// A time: the fraction `n / d` of a move, with `d > 0`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Time {
    pub(super) n: i128,
    pub(super) d: i128,
}

impl Time {
    pub(super) fn new(n: i128, d: i128) -> Time {
        if d < 0 {
            Time { n: -n, d: -d }
        } else {
            Time { n, d }
        }
    }

    fn is_before(self, other: Time) -> bool {
        self.n * other.d < other.n * self.d
    }

    pub(super) fn value(self) -> f64 {
        self.n as f64 / self.d as f64
    }
}

/// A closed interval of fractions of a move, initially 0 to 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stretch {
    pub(super) from: Time,
    pub(super) to: Time,
}

impl Stretch {
    pub(super) const WHOLE: Stretch = Stretch {
        from: Time { n: 0, d: 1 },
        to: Time { n: 1, d: 1 },
    };

    /// Returns the part of the interval during which `low <= start + t speed <= high`.
    pub(super) fn while_within(
        self,
        start: i128,
        speed: i128,
        low: i128,
        high: i128,
    ) -> Option<Stretch> {
        if speed == 0 {
            return (low <= start && start <= high).then_some(self);
        }
        let (first, last) = if speed > 0 { (low, high) } else { (high, low) };
        let (enters, leaves) = (
            Time::new(first - start, speed),
            Time::new(last - start, speed),
        );
        let from = if self.from.is_before(enters) {
            enters
        } else {
            self.from
        };
        let to = if leaves.is_before(self.to) {
            leaves
        } else {
            self.to
        };
        (!to.is_before(from)).then_some(Stretch { from, to })
    }
}
