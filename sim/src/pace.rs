//! The one place where rig time meets tokio's clock: one rig microsecond is one tokio millisecond.
//!
//! tokio's timers have a grain of a millisecond; stretched a thousand times under the paused clock
//! they keep every microsecond of the rig.

use std::time::Duration;
use tokio::time::Instant;

/// Rig time of a runtime with a paused clock.
#[derive(Debug, Clone, Copy)]
pub struct Pace {
    origin: Instant,
}

impl Pace {
    /// Rig time 0 is now.
    pub fn start() -> Self {
        Self {
            origin: Instant::now(),
        }
    }

    /// Rig time, microseconds.
    pub fn now_us(&self) -> u64 {
        self.origin.elapsed().as_millis() as u64
    }

    /// Instant of the tokio clock at rig time `t_us`.
    pub fn at(&self, t_us: u64) -> Instant {
        self.origin + Duration::from_millis(t_us)
    }
}
