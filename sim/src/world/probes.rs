//! What the interface board and a specimen exchange through the five pairs of probes, whatever kind the specimen is.

/// One of the two contacts that a specimen may have between its output pins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Contact {
    /// Normally open.
    No,
    /// Normally closed.
    Nc,
}

/// A contact has opened or closed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Change {
    /// Instant, microseconds.
    pub t_us: f64,
    /// Which contact.
    pub contact: Contact,
    /// Closed from now on.
    pub closed: bool,
}

/// What drives the input pins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Supply {
    /// A source, V.
    Volts(f64),
    /// Nothing but the clamp, volts across it while current flows.
    Off {
        /// Forward voltage of the clamp.
        clamp_v: f64,
    },
}

impl Supply {
    /// Volts that a source applies.
    pub fn volts(self) -> f64 {
        match self {
            Self::Volts(v) => v,
            Self::Off { .. } => 0.0,
        }
    }
}

/// Which of the five pins meet their probes: input a, input b, common, NO, NC.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pins {
    /// The pin that belongs there is there.
    pub present: [bool; 5],
    /// Force and sense probe meet on metal: the Kelvin test finds it good, whatever pin it is.
    pub kelvin: [bool; 5],
}

impl Pins {
    /// Every pin meets its probes.
    pub const ALL: Self = Self {
        present: [true; 5],
        kelvin: [true; 5],
    };

    /// The body lies the wrong way round: other pins meet four of the five pairs.
    pub const TURNED: Self = Self {
        present: [false; 5],
        kelvin: [true, true, false, true, true],
    };

    /// A pin meets its probes no more.
    pub fn lose(&mut self, pin: usize) {
        self.present[pin] = false;
        self.kelvin[pin] = false;
    }

    /// The input can be driven.
    pub fn input(self) -> bool {
        self.present[0] && self.present[1]
    }

    /// A contact can be seen.
    pub fn contact(self, contact: Contact) -> bool {
        let own = match contact {
            Contact::No => self.present[3],
            Contact::Nc => self.present[4],
        };
        self.present[2] && own
    }
}
