//! Maps rig time to tokio's clock: one rig microsecond is one tokio millisecond.
//!
//! The timers of tokio resolve 1 ms, so the mapping gives them a resolution of 1 us of rig time. With the clock of
//! tokio paused, the thousandfold waits take no wall time.

use std::time::Duration;
use tokio::time::Instant;

/// Rig clock of a runtime with a paused clock.
#[derive(Debug, Clone, Copy)]
pub struct Pace {
    origin: Instant,
}

impl Pace {
    /// Starts the clock; rig time 0 is now.
    pub fn start() -> Self {
        Self {
            origin: Instant::now(),
        }
    }

    /// Returns rig time, microseconds.
    pub fn now_us(&self) -> u64 {
        self.origin.elapsed().as_millis() as u64
    }

    /// Returns the instant of the tokio clock at rig time `t_us`.
    pub fn at(&self, t_us: u64) -> Instant {
        self.origin + Duration::from_millis(t_us)
    }
}
