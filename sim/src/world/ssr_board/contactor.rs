//! A contactor: its main contacts follow the coil after an operate time; a mirror contact is closed while they are open.

/// Damage of a contactor.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Damage {
    /// Closed main contacts stay closed.
    pub welded: bool,
    /// The coil is broken: open main contacts stay open, closed ones open.
    pub broken: bool,
}

/// One contactor.
#[derive(Debug, Clone)]
pub struct Contactor {
    /// Time from coil on to main contacts closed, microseconds; the next field is the time from coil off to open.
    close_us: f64,
    open_us: f64,
    coil: bool,
    closed: bool,
    due_us: f64,
    damage: Damage,
}

impl Contactor {
    /// Creates an open contactor with its times to close and to open, microseconds.
    pub fn new(close_us: f64, open_us: f64) -> Self {
        Self {
            close_us,
            open_us,
            coil: false,
            closed: false,
            due_us: f64::INFINITY,
            damage: Damage::default(),
        }
    }

    /// Switches the coil on or off at `now_us`.
    pub fn energise(&mut self, coil: bool, now_us: f64) {
        let coil = coil && !self.damage.broken;
        if std::mem::replace(&mut self.coil, coil) != coil {
            let after_us = if coil { self.close_us } else { self.open_us };
            self.due_us = now_us + after_us;
        }
    }

    /// Sets the damage at `now_us`.
    pub fn damage(&mut self, damage: Damage, now_us: f64) {
        if std::mem::replace(&mut self.damage, damage) != damage {
            self.due_us = self.due_us.min(now_us + self.open_us);
        }
    }

    /// Returns the instant at which the main contacts move next, microseconds; infinite when no move is due.
    pub fn due_us(&self) -> f64 {
        self.due_us
    }

    /// Moves the main contacts if they are due; returns true when they have moved.
    pub fn expire(&mut self, now_us: f64) -> bool {
        if self.due_us > now_us {
            return false;
        }
        self.due_us = f64::INFINITY;
        let closed = self.coil || self.closed && self.damage.welded;
        std::mem::replace(&mut self.closed, closed) != closed
    }

    /// Checks whether the main contacts are closed.
    pub fn is_closed(&self) -> bool {
        self.closed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settled(contactor: &mut Contactor, now_us: f64) -> bool {
        contactor.expire(now_us);
        contactor.is_closed()
    }

    #[test]
    fn main_contacts_follow_the_coil_after_their_times() {
        let mut it = Contactor::new(15_000.0, 10_000.0);
        it.energise(true, 0.0);
        assert_eq!(it.due_us(), 15_000.0);
        assert!(!settled(&mut it, 14_999.0) && settled(&mut it, 15_000.0));
        it.energise(false, 20_000.0);
        assert!(settled(&mut it, 29_999.0) && !settled(&mut it, 30_000.0));
    }

    #[test]
    fn a_welded_contactor_opens_when_it_is_mended() {
        let mut it = Contactor::new(15_000.0, 10_000.0);
        let welded = Damage {
            welded: true,
            broken: false,
        };
        it.damage(welded, 0.0);
        assert!(!settled(&mut it, 10_000.0), "it welds only when closed");
        it.energise(true, 10_000.0);
        assert!(settled(&mut it, 25_000.0));
        it.energise(false, 30_000.0);
        assert!(settled(&mut it, 60_000.0));
        it.damage(Damage::default(), 70_000.0);
        assert!(!settled(&mut it, 80_000.0));
    }

    #[test]
    fn a_broken_coil_closes_nothing() {
        let mut it = Contactor::new(15_000.0, 10_000.0);
        let broken = Damage {
            welded: false,
            broken: true,
        };
        it.damage(broken, 0.0);
        it.energise(true, 0.0);
        assert!(!settled(&mut it, 50_000.0));
    }
}
