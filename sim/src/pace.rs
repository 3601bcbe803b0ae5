//! Maps rig time to virtual time.

/// Rig clock in virtual time. Copies work only on the thread that started it, in a runtime of
/// [`virtual_time::builder`].
#[derive(Debug, Clone, Copy)]
pub struct Pace {
    /// Virtual time at which the clock started, and rig time then, microseconds.
    started_us: (u64, u64),
}

impl Pace {
    /// Starts the clock; rig time is `rig_us` now.
    pub fn start(rig_us: u64) -> Self {
        Self {
            started_us: (virtual_time::now_us(), rig_us),
        }
    }

    /// Returns rig time, microseconds.
    pub fn now_us(&self) -> u64 {
        let (virtual_us, rig_us) = self.started_us;
        rig_us + (virtual_time::now_us() - virtual_us)
    }

    /// Waits until rig time `t_us`; returns at once if that has passed.
    pub async fn sleep_until(self, t_us: u64) {
        let (virtual_us, rig_us) = self.started_us;
        virtual_time::sleep_until(virtual_us + t_us.saturating_sub(rig_us)).await;
    }
}
