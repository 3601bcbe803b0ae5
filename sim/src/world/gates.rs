//! Window flip-flop, latch and the two counter gates of the interface board.
//!
//! - Window W: ARM clears it; the start event sets it while the latch is clear; the opposite edge of the drive clears
//!   it, and so does the time-out that the latch starts.
//! - Latch L: the selected contact event sets it while W is set; ARM clears it.
//! - Gate 0 = W and not L. Gate 1 = W and not the selected contact.
//! - ARM with the reference contact selected opens both gates for the reference pulse instead.
//!
//! Each gate has its own delay: the first time that a gate opens after an ARM, the delay lengthens its open time (or
//! shortens it, if negative).

/// The two counter gates with their flip-flops.
#[derive(Debug, Clone)]
pub struct Gates {
    window: bool,
    latch: bool,
    contact_closed: bool,
    window_ends_us: Option<f64>,
    pulse_ends_us: Option<f64>,
    after_latch_us: f64,
    delay_us: [f64; 2],
    delayed: [bool; 2],
    total_us: [f64; 2],
    open_from_us: [Option<f64>; 2],
}

impl Gates {
    /// Creates gates 0 and 1 with their delays; a window closes at the latest `after_latch_us` after its latch is set.
    pub fn new(delay_us: [f64; 2], after_latch_us: f64) -> Self {
        Self {
            window: false,
            latch: false,
            contact_closed: false,
            window_ends_us: None,
            pulse_ends_us: None,
            after_latch_us,
            delay_us,
            delayed: [false; 2],
            total_us: [0.0; 2],
            open_from_us: [None; 2],
        }
    }

    /// Returns the state of the window flip-flop.
    pub fn window(&self) -> bool {
        self.window
    }

    /// Returns the state of the latch.
    pub fn latch(&self) -> bool {
        self.latch
    }

    /// Returns the total open time of a gate up to `t_us`, microseconds.
    pub fn open_us(&self, gate: usize, t_us: f64) -> f64 {
        let running = self.open_from_us[gate].map_or(0.0, |from| (t_us - from).max(0.0));
        self.total_us[gate] + running
    }

    /// Clears both flip-flops; with a pulse length it also opens both gates for that time.
    pub fn arm(&mut self, t_us: f64, pulse_us: Option<f64>) {
        self.window = false;
        self.latch = false;
        self.window_ends_us = None;
        self.pulse_ends_us = None;
        self.update(t_us);
        self.delayed = [false; 2];
        self.pulse_ends_us = pulse_us.map(|p| t_us + p);
        self.update(t_us);
    }

    /// Applies the start event.
    pub fn start(&mut self, t_us: f64) {
        if !self.latch {
            self.window = true;
            self.update(t_us);
        }
    }

    /// Closes the window at the edge of the coil drive opposite to the edge that opened it.
    pub fn opposite(&mut self, t_us: f64) {
        self.window = false;
        self.window_ends_us = None;
        self.update(t_us);
    }

    /// Applies the selected contact event.
    pub fn event(&mut self, t_us: f64) {
        if self.window && !self.latch {
            self.latch = true;
            self.window_ends_us = Some(t_us + self.after_latch_us);
            self.update(t_us);
        }
    }

    /// Sets the state of the selected contact that the monitor detects.
    pub fn contact(&mut self, t_us: f64, closed: bool) {
        if self.contact_closed != closed {
            self.contact_closed = closed;
            self.update(t_us);
        }
    }

    /// Returns the next instant at which the window or the reference pulse times out; `None` when neither is running.
    pub fn next_us(&self) -> Option<f64> {
        let ends = [self.window_ends_us, self.pulse_ends_us];
        ends.into_iter().flatten().min_by(f64::total_cmp)
    }

    /// Ends the reference pulse or window whose time is over.
    pub fn expire(&mut self, t_us: f64) {
        if self.window_ends_us.is_some_and(|end| end <= t_us) {
            self.window = false;
            self.window_ends_us = None;
        }
        if self.pulse_ends_us.is_some_and(|end| end <= t_us) {
            self.pulse_ends_us = None;
        }
        self.update(t_us);
    }

    fn update(&mut self, t_us: f64) {
        let pulse = self.pulse_ends_us.is_some();
        self.set(0, t_us, pulse || self.window && !self.latch);
        self.set(1, t_us, pulse || self.window && !self.contact_closed);
    }

    fn set(&mut self, gate: usize, t_us: f64, open: bool) {
        match (open, self.open_from_us[gate]) {
            (true, None) => {
                let delay = if self.delayed[gate] {
                    0.0
                } else {
                    self.delay_us[gate]
                };
                self.delayed[gate] = true;
                self.open_from_us[gate] = Some(t_us - delay);
            }
            (false, Some(from)) => {
                self.total_us[gate] += (t_us - from).max(0.0);
                self.open_from_us[gate] = None;
            }
            (true, Some(_)) | (false, None) => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gates() -> Gates {
        Gates::new([0.0, 0.0], 20_000.0)
    }

    #[test]
    fn gate_0_runs_from_start_event_to_latch() {
        let mut g = gates();
        g.arm(0.0, None);
        g.start(100.0);
        g.event(4_800.0);
        assert!(g.latch() && g.window());
        assert_eq!(g.open_us(0, 9_000.0), 4_700.0);
    }

    #[test]
    fn gate_1_counts_the_open_time_of_bounce() {
        let mut g = gates();
        g.arm(0.0, None);
        g.start(100.0);
        for (t, closed) in [(4_800.0, true), (4_900.0, false), (5_100.0, true)] {
            if closed {
                g.event(t);
            }
            g.contact(t, closed);
        }
        assert_eq!(g.open_us(1, 9_000.0) - g.open_us(0, 9_000.0), 200.0);
    }

    #[test]
    fn a_gate_without_an_event_keeps_counting() {
        let mut g = gates();
        g.arm(0.0, None);
        g.start(0.0);
        assert!(g.open_us(0, 2.0) > g.open_us(0, 1.0));
        g.opposite(50.0);
        assert_eq!(g.open_us(0, 90.0), 50.0);
    }

    #[test]
    fn the_latch_needs_the_window_and_arm_clears_both() {
        let mut g = gates();
        g.event(1.0);
        assert!(!g.latch());
        g.start(2.0);
        g.event(3.0);
        g.arm(4.0, None);
        assert!(!g.latch() && !g.window());
    }

    #[test]
    fn the_window_closes_twenty_milliseconds_after_the_latch() {
        let mut g = gates();
        g.start(0.0);
        g.event(10.0);
        assert_eq!(g.next_us(), Some(20_010.0));
        g.expire(20_010.0);
        assert!(!g.window() && g.latch());
        g.start(30_000.0);
        assert!(!g.window(), "a latched event must not be measured again");
    }

    #[test]
    fn the_reference_pulse_opens_both_gates_with_their_delays() {
        let mut g = Gates::new([7.0, -4.0], 20_000.0);
        g.contact(0.0, true);
        g.arm(5.0, Some(1_000.0));
        g.expire(1_005.0);
        assert_eq!(g.open_us(0, 2_000.0), 1_007.0);
        assert_eq!(g.open_us(1, 2_000.0), 996.0);
    }
}
