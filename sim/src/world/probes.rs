//! Signals between the interface board and a specimen of any kind, through the five pairs of probes.

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
    /// Contact that has changed.
    pub contact: Contact,
    /// True when the contact has closed, false when it has opened.
    pub closed: bool,
}

/// Drive at the input pins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Supply {
    /// A voltage source, V.
    Volts(f64),
    /// No source; the suppression holds its voltage while current flows.
    Off {
        /// Voltage of the suppression, V.
        suppression_v: f64,
    },
}

impl Supply {
    /// Returns the voltage of the source; 0 without a source.
    pub fn volts(self) -> f64 {
        match self {
            Self::Volts(v) => v,
            Self::Off { .. } => 0.0,
        }
    }
}

/// Connection of the five pins: input a, input b, common, NO, NC.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pins {
    /// For each probe pair: the right pin is present.
    pub present: [bool; 5],
    /// For each probe pair: force and sense probe touch metal of any pin, so that the Kelvin test passes.
    pub kelvin: [bool; 5],
}

impl Pins {
    /// Every pin touches its probes.
    pub const ALL: Self = Self {
        present: [true; 5],
        kelvin: [true; 5],
    };

    /// The body is misoriented: wrong pins touch four of the five pairs.
    pub const MISORIENTED: Self = Self {
        present: [false; 5],
        kelvin: [true, true, false, true, true],
    };

    /// Removes the pin and its connection.
    pub fn lose(&mut self, pin: usize) {
        self.present[pin] = false;
        self.kelvin[pin] = false;
    }

    /// Checks whether the coil probes reach both input pins, so that the board can drive the input.
    pub fn input(self) -> bool {
        self.present[0] && self.present[1]
    }

    /// Checks whether the probes reach the pins of a contact, so that the board can sense it.
    pub fn contact(self, contact: Contact) -> bool {
        let own = match contact {
            Contact::No => self.present[3],
            Contact::Nc => self.present[4],
        };
        self.present[2] && own
    }
}
