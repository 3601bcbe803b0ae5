//! The host watchdog of one module.
//!
//! Only `~**` feeds it. When it expires the outputs fall to their safe values, status 04 goes to
//! the EEPROM, the watchdog disables itself, and every output command is answered with bare `!`
//! until `~AA1` clears the status. A watchdog that is enabled at power-on begins to count with the
//! first `~**` it hears (not documented; so a rig may wait for its controller); one that is enabled
//! by `~AA3` counts at once.

/// Status of a module whose watchdog has expired, as `~AA0` shows it.
const TRIPPED: u8 = 0x04;

/// Enable flag, time-out and state.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Watchdog {
    enabled: bool,
    /// In tenths of a second, 1 to 255.
    tenths: u8,
    expires_us: Option<u64>,
    tripped: bool,
}

impl Watchdog {
    /// As found at power-on.
    pub fn new(enabled: bool, tenths: u8, tripped: bool) -> Self {
        Self {
            enabled,
            tenths,
            expires_us: None,
            tripped,
        }
    }

    /// Starts over with new values, now.
    pub fn set(&mut self, enabled: bool, tenths: u8, now_us: u64) {
        self.enabled = enabled;
        self.tenths = tenths;
        self.expires_us = enabled.then(|| self.deadline(now_us));
    }

    /// The host is well.
    pub fn feed(&mut self, now_us: u64) {
        if self.enabled {
            self.expires_us = Some(self.deadline(now_us));
        }
    }

    /// Instant at which it expires, if nobody feeds it.
    pub fn expires_us(&self) -> Option<u64> {
        self.expires_us
    }

    /// It has expired: remembers the trip and disables itself.
    pub fn trip(&mut self) {
        self.enabled = false;
        self.expires_us = None;
        self.tripped = true;
    }

    /// Forgets the trip.
    pub fn clear(&mut self) {
        self.tripped = false;
    }

    /// Outputs are held at their safe values.
    pub fn tripped(&self) -> bool {
        self.tripped
    }

    /// Answer to `~AA0`.
    pub fn status(&self) -> u8 {
        if self.tripped { TRIPPED } else { 0 }
    }

    /// Enable flag and time-out in tenths of a second.
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
    fn a_watchdog_waits_for_its_first_host_and_then_insists() {
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
