//! Rig time, and the timers on which it runs.
//!
//! At real pace, rig time follows the wall clock. At virtual pace it follows tokio's paused clock, which jumps to the
//! next deadline as soon as every task waits. Tokio's timers have steps of one millisecond, too coarse for characters
//! of 87 us; so at virtual pace *one microsecond of rig time is one millisecond of tokio's clock*. In this crate only
//! this file knows the factor.

use std::time::Duration;
use tokio::time::{Instant, Sleep};
use units::{RigTime, Span};

/// Clock of the rig. Copies show the same time.
#[derive(Debug, Clone, Copy)]
pub struct Pace {
    began: Instant,
    is_virtual: bool,
}

/// Rig time between two pauses with which [`Pace::limit_speed`] slows virtual time: half the time of a screen frame.
const HOLD: Span = Span(10_000);

impl Pace {
    /// Returns a clock at real pace; its time 0 is now.
    pub fn real() -> Self {
        Self {
            began: Instant::now(),
            is_virtual: false,
        }
    }

    /// Returns a clock at virtual pace; its time 0 is now. Needs a current-thread runtime whose clock is paused.
    pub fn virtual_time() -> Self {
        Self {
            began: Instant::now(),
            is_virtual: true,
        }
    }

    /// Returns true at virtual pace.
    pub fn is_virtual(&self) -> bool {
        self.is_virtual
    }

    /// Returns the rig time: microseconds since the clock was created.
    pub fn now(&self) -> RigTime {
        let elapsed = self.began.elapsed();
        RigTime(if self.is_virtual {
            elapsed.as_millis()
        } else {
            elapsed.as_micros()
        } as u64)
    }

    /// Returns a timer that fires at `until`; at real pace up to two milliseconds later, never earlier.
    pub fn sleep(&self, until: RigTime) -> Sleep {
        let since_began = if self.is_virtual {
            Duration::from_millis(until.0)
        } else {
            Duration::from_micros(until.0)
        };
        tokio::time::sleep_until(self.began + since_began)
    }

    /// Waits until `until`; returns at once if that time has passed.
    pub async fn sleep_until(&self, until: RigTime) {
        if self.now() < until {
            self.sleep(until).await;
        }
    }

    /// Slows virtual time to at most `speed` times the wall clock; never returns. When a busy machine slows virtual
    /// time further, it does not catch up afterwards.
    pub async fn limit_speed(self, speed: f64) {
        assert!(
            speed > 0.0 && speed.is_finite(),
            "the speed is not positive and finite"
        );
        let wall = Duration::from_micros(HOLD.0).div_f64(speed);
        loop {
            let began = std::time::Instant::now();
            self.sleep(self.now() + HOLD).await;
            std::thread::sleep(wall.saturating_sub(began.elapsed()));
        }
    }
}
