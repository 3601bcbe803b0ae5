//! The host watchdog of one module.
//!
//! Only `~**` feeds the watchdog. When it expires, the outputs take their safe values, status 04 goes to the
//! EEPROM, the watchdog disables itself, and every output command gets bare `!` until `~AA1` clears the status. A
//! watchdog that is enabled at power-on starts with the first `~**` (undocumented; the outputs of a rig can thus wait
//! for its controller); one that `~AA3` enables starts at once.

/// Status of a tripped watchdog in the reply to `~AA0`.
const TRIPPED: u8 = 0x04;

/// Enable flag, time-out and state of the watchdog.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Watchdog {
    enabled: bool,
    /// Time-out in tenths of a second, 1 to 255.
    tenths: u8,
    expires_us: Option<u64>,
    tripped: bool,
}

impl Watchdog {
    /// Creates the watchdog in its state at power-on.
    pub fn new(enabled: bool, tenths: u8, tripped: bool) -> Self {
        Self {
            enabled,
            tenths,
            expires_us: None,
            tripped,
        }
    }

    /// Restarts the watchdog with new settings at `now_us`.
    pub fn set(&mut self, enabled: bool, tenths: u8, now_us: u64) {
        self.enabled = enabled;
        self.tenths = tenths;
        self.expires_us = enabled.then(|| self.deadline(now_us));
    }

    /// Feeds the watchdog (`~**`).
    pub fn feed(&mut self, now_us: u64) {
        if self.enabled {
            self.expires_us = Some(self.deadline(now_us));
        }
    }

    /// Returns the instant at which the watchdog expires unless the host feeds it; `None` while it does not run.
    pub fn expires_us(&self) -> Option<u64> {
        self.expires_us
    }

    /// Trips the watchdog: stores the status and disables it.
    pub fn trip(&mut self) {
        self.enabled = false;
        self.expires_us = None;
        self.tripped = true;
    }

    /// Clears the trip status.
    pub fn clear(&mut self) {
        self.tripped = false;
    }

    /// Checks whether the watchdog holds the outputs at their safe values.
    pub fn tripped(&self) -> bool {
        self.tripped
    }

    /// Returns the status in the reply to `~AA0`.
    pub fn status(&self) -> u8 {
        if self.tripped { TRIPPED } else { 0 }
    }

    /// Returns the enable flag and the time-out in tenths of a second.
    pub fn setting(&self) -> (bool, u8) {
        (self.enabled, self.tenths)
    }

    fn deadline(&self, now_us: u64) -> u64 {
        now_us + u64::from(self.tenths) * 100_000
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_watchdog_starts_with_its_first_host_request() {
        let mut dog = Watchdog::new(true, 10, false);
        assert_eq!(dog.expires_us(), None);
        dog.feed(500);
        assert_eq!(dog.expires_us(), Some(1_000_500));
        dog.trip();
        assert_eq!((dog.status(), dog.setting()), (0x04, (false, 10)));
        dog.feed(2_000_000);
        assert_eq!(dog.expires_us(), None);
    }
}
