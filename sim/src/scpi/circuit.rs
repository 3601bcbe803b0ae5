//! Electrical boundary between instruments and what hangs at their terminals.

use crate::table::read_words;

/// Pair of terminals to which an instrument connects.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Terminal {
    /// Control input of the part, from a source-measure unit.
    Input,
    /// Control input of the part, from a pulse source.
    Pulse,
    /// Output of the part, from a source-measure unit or multimeter.
    Output,
    /// Line side of the load circuit, from an AC source.
    Line,
    /// Load current, as the voltage over the shunt divided by its resistance.
    Load,
    /// Voltage over the output behind the clamp of +-10 V.
    Clamped,
}

read_words!(Terminal {
    "input" => Self::Input,
    "pulse" => Self::Pulse,
    "output" => Self::Output,
    "line" => Self::Line,
    "load" => Self::Load,
    "clamped" => Self::Clamped,
});

/// Source behind a pair of terminals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Drive {
    /// No connection.
    Open,
    /// Voltage source with a limit of its current, amperes.
    Voltage {
        /// Volts.
        volts: f64,
        /// Amperes.
        limit_a: f64,
    },
    /// Current source with a limit of its voltage, volts.
    Current {
        /// Amperes.
        amps: f64,
        /// Volts.
        limit_v: f64,
    },
    /// Sine of a line.
    Sine {
        /// Volts rms.
        rms_v: f64,
        /// Hertz.
        hz: f64,
        /// Phase at the instant of this drive, degrees.
        phase_deg: f64,
        /// Limit of the current, amperes rms.
        limit_a: f64,
    },
    /// Rectangular pulses from the instant of this drive on.
    Pulses(Pulses),
}

/// A train of rectangular pulses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pulses {
    /// Volts between the pulses.
    pub low_v: f64,
    /// Volts of a pulse.
    pub high_v: f64,
    /// Interval between two rising edges, microseconds.
    pub period_us: f64,
    /// Time at the high level, microseconds.
    pub width_us: f64,
    /// Number of pulses; `None` never ends.
    pub count: Option<u64>,
}

impl Pulses {
    /// Returns the volts `since_us` after the start.
    pub fn volts(&self, since_us: f64) -> f64 {
        let number = (since_us / self.period_us).floor();
        let within = since_us - number * self.period_us < self.width_us;
        let ended = self.count.is_some_and(|count| number >= count as f64);
        if within && !ended {
            self.high_v
        } else {
            self.low_v
        }
    }
}

/// Voltage and current at a pair of terminals; the current flows out of the instrument.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Reading {
    /// Volts.
    pub volts: f64,
    /// Amperes.
    pub amps: f64,
}

/// What hangs at the terminals of the instruments.
pub trait Circuit: Send {
    /// Advances to `t_us`, which never decreases.
    fn advance(&mut self, t_us: u64);

    /// Connects a source from the present instant on.
    fn drive(&mut self, terminal: Terminal, drive: Drive);

    /// Returns voltage and current at the present instant.
    fn at(&mut self, terminal: Terminal) -> Reading;
}

/// Returns the operating point of a source over a resistor.
pub fn over_resistor(drive: Drive, ohms: f64) -> Reading {
    match drive {
        Drive::Voltage { volts, limit_a } => {
            let amps = (volts / ohms).clamp(-limit_a, limit_a);
            let volts = if ohms.is_infinite() {
                volts
            } else {
                amps * ohms
            };
            Reading { volts, amps }
        }
        Drive::Current { amps, limit_v } => {
            let volts = (amps * ohms).clamp(-limit_v, limit_v);
            Reading {
                volts,
                amps: volts / ohms,
            }
        }
        Drive::Open | Drive::Sine { .. } | Drive::Pulses(_) => Reading::default(),
    }
}
