//! Rig time and the timers below it.
//!
//! Real pace runs with the wall clock. Virtual pace runs under tokio's paused clock: time jumps to the next
//! deadline whenever every task waits. Tokio's timers have a grain of one millisecond, far too coarse for characters of
//! 87 us; so in virtual pace *one microsecond of the rig is one millisecond of tokio*. Only this file knows.

use std::time::Duration;
use tokio::time::{Instant, Sleep};
use units::{RigTime, Span};

/// The rig's clock. Copies show the same time.
#[derive(Debug, Clone, Copy)]
pub struct Pace {
    began: Instant,
    is_virtual: bool,
}

/// The end of a real rest is slept on the thread: tokio's timer may be so late.
const FINE: Span = Span(2_000);
/// A virtual clock that is held back stands this long at a time: half a frame of a screen.
const HOLD: Span = Span(10_000);

impl Pace {
    /// Wall-clock pace; rig time 0 is now.
    pub fn real() -> Self {
        Self {
            began: Instant::now(),
            is_virtual: false,
        }
    }

    /// Virtual pace; rig time 0 is now. For a current-thread runtime whose clock is paused.
    pub fn virtual_time() -> Self {
        Self {
            began: Instant::now(),
            is_virtual: true,
        }
    }

    /// True in virtual pace.
    pub fn is_virtual(&self) -> bool {
        self.is_virtual
    }

    /// Microseconds since the pace was made.
    pub fn now(&self) -> RigTime {
        let elapsed = self.began.elapsed();
        RigTime(if self.is_virtual {
            elapsed.as_millis()
        } else {
            elapsed.as_micros()
        } as u64)
    }

    /// A timer that ends at `until`, not earlier; in real pace up to two milliseconds later.
    pub fn sleep(&self, until: RigTime) -> Sleep {
        let since_began = if self.is_virtual {
            Duration::from_millis(until.0)
        } else {
            Duration::from_micros(until.0)
        };
        tokio::time::sleep_until(self.began + since_began)
    }

    /// Waits until `until`; at once when it has passed.
    pub async fn sleep_until(&self, until: RigTime) {
        if self.now() < until {
            self.sleep(until).await;
        }
    }

    /// As [`Pace::sleep_until`], true to some 0.1 ms in real pace: the last two milliseconds keep the thread. For turnarounds.
    pub async fn rest_until(&self, until: RigTime) {
        if self.is_virtual {
            return self.sleep_until(until).await;
        }
        if until.since(self.now()) > FINE {
            self.sleep(RigTime(until.0 - FINE.0)).await;
        }
        let left = until.since(self.now());
        if left > Span(0) {
            std::thread::sleep(Duration::from_micros(left.0));
        }
    }

    /// Keeps virtual time from passing faster than `speed` times the wall clock, for ever. Time lost on a busy machine is
    /// not made up for: the rig gets slow there, never late.
    pub async fn hold_back(self, speed: f64) {
        assert!(speed > 0.0 && speed.is_finite(), "a clock that stands");
        let wall = Duration::from_micros(HOLD.0).div_f64(speed);
        loop {
            let began = std::time::Instant::now();
            self.sleep(self.now() + HOLD).await;
            std::thread::sleep(wall.saturating_sub(began.elapsed()));
        }
    }
}
