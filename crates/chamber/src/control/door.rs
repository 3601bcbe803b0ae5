//! Open door: the heater is off, and the integral of the feedback pauses until the air has recovered.

/// Time after closing for which the integral pauses, s.
const REST_S: u32 = 30;

/// Tracks the door, stepped once a second.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct DoorHold {
    left_s: u32,
}

impl DoorHold {
    /// Returns true while the integral pauses: the door is open, or has been closed for less than 30 s.
    pub fn step(&mut self, open: bool) -> bool {
        self.left_s = if open {
            REST_S
        } else {
            self.left_s.saturating_sub(1)
        };
        self.left_s > 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_integral_rests_for_half_a_minute_after_closing() {
        let mut door = DoorHold::default();
        assert!(!door.step(false));
        assert!(door.step(true));
        let rests = (0..100).filter(|_| door.step(false)).count();
        assert_eq!(rests, 29);
    }
}
