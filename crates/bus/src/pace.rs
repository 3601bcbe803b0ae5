//! Rig time, and the timers on which it runs.
//!
//! At real pace, rig time follows the wall clock, with the timers of tokio in steps of a millisecond. At virtual pace it
//! follows the clock of the crate `virtual_time`, in steps of a microsecond: a character takes 87 us.

use std::time::Duration;
use tokio::time::Instant;
use units::{RigTime, Span};

/// Clock of the rig. Copies show the same time; at virtual pace only on the thread that created the clock.
#[derive(Debug, Clone, Copy)]
pub struct Pace(Clock);

/// Clock that a pace follows, with its reading at rig time 0.
#[derive(Debug, Clone, Copy)]
enum Clock {
    Wall(Instant),
    /// Microseconds of virtual time.
    Virtual(u64),
}

/// Rig time between two pauses with which [`Pace::limit_speed`] slows virtual time: half the time of a screen frame.
const HOLD: Span = Span(10_000);

impl Pace {
    /// Returns a clock at real pace; its time 0 is now.
    pub fn real() -> Self {
        Self(Clock::Wall(Instant::now()))
    }

    /// Returns a clock at virtual pace; its time 0 is now. Timers need a runtime of [`virtual_time::builder`].
    pub fn virtual_time() -> Self {
        Self(Clock::Virtual(virtual_time::now_us()))
    }

    /// Returns true at virtual pace.
    pub fn is_virtual(&self) -> bool {
        matches!(self.0, Clock::Virtual(_))
    }

    /// Returns the rig time: microseconds since the clock was created.
    pub fn now(&self) -> RigTime {
        RigTime(match self.0 {
            Clock::Wall(began) => began.elapsed().as_micros() as u64,
            Clock::Virtual(began_us) => {
                let now_us = virtual_time::now_us();
                assert!(now_us >= began_us, "the clock of another thread");
                now_us - began_us
            }
        })
    }

    /// Waits until `until`, at real pace up to two milliseconds longer; returns at once if that time has passed.
    pub async fn sleep_until(self, until: RigTime) {
        match self.0 {
            Clock::Wall(_) if self.now() >= until => {}
            Clock::Wall(began) => {
                tokio::time::sleep_until(began + Duration::from_micros(until.0)).await;
            }
            Clock::Virtual(began_us) => virtual_time::sleep_until(began_us + until.0).await,
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
            self.sleep_until(self.now() + HOLD).await;
            std::thread::sleep(wall.saturating_sub(began.elapsed()));
        }
    }
}
