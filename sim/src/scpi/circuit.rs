//! Electrical boundary between the instruments and the circuit that they connect to.

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
    /// Load current; a digitizer sees it as a voltage over a shunt.
    Load,
    /// Load current, as the voltage over the present shunt of the load circuit.
    Shunt,
    /// Voltage over the output at the socket of the part, apart from the wires of an instrument.
    Socket,
    /// Voltage over the output, clamped to +-10 V.
    Clamped,
}

read_words!(Terminal {
    "input" => Self::Input,
    "pulse" => Self::Pulse,
    "output" => Self::Output,
    "line" => Self::Line,
    "load" => Self::Load,
    "shunt" => Self::Shunt,
    "socket" => Self::Socket,
    "clamped" => Self::Clamped,
});

/// Source that an instrument connects to a pair of terminals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Drive {
    /// No connection.
    Open,
    /// Voltage source.
    Voltage {
        /// Volts without load.
        volts: f64,
        /// Limit of the current, amperes.
        limit_a: f64,
        /// Resistance in series with the source, ohms.
        source_ohm: f64,
    },
    /// Current source.
    Current {
        /// Amperes.
        amps: f64,
        /// Limit of the voltage, volts.
        limit_v: f64,
    },
    /// Sine of an AC source.
    Sine {
        /// Volts rms.
        rms_v: f64,
        /// Hertz.
        hz: f64,
        /// Phase at the instant when this drive begins, degrees; `None` continues the present phase.
        phase_deg: Option<f64>,
    },
    /// Rectangular pulses, which begin with this drive.
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
    /// Time from the begin of this drive to the first rising edge, microseconds.
    pub delay_us: f64,
    /// Number of pulses; `None` for an endless train.
    pub count: Option<u64>,
    /// Resistance in series with the source, ohms.
    pub source_ohm: f64,
}

impl Pulses {
    /// Returns the volts `since_us` after the first rising edge, without load.
    pub fn volts(&self, since_us: f64) -> f64 {
        match self.edge_us(since_us) {
            Some((_, true)) => self.high_v,
            Some((_, false)) | None => self.low_v,
        }
    }

    /// Returns the time from `since_us` to the next edge, microseconds, and whether the level is high until then;
    /// `None` after the last pulse.
    pub fn edge_us(&self, since_us: f64) -> Option<(f64, bool)> {
        let number = (since_us / self.period_us).floor();
        if self.count.is_some_and(|count| number >= count as f64) {
            return None;
        }
        let within_us = since_us - number * self.period_us;
        Some(match within_us < self.width_us {
            true => (self.width_us - within_us, true),
            false => (self.period_us - within_us, false),
        })
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

/// Circuit that the instruments drive and measure.
pub trait Circuit: Send {
    /// Advances to `t_us`, which never decreases.
    fn advance(&mut self, t_us: u64);

    /// Connects a source from the present instant on.
    fn drive(&mut self, terminal: Terminal, drive: Drive);

    /// Returns voltage and current at the present instant.
    fn at(&self, terminal: Terminal) -> Reading;

    /// Returns the present phase of the line, 0 to 360 degrees.
    fn line_deg(&self) -> f64;
}

/// Returns the operating point of a source over a resistor, which may be a short or open (infinite).
pub fn over_resistor(drive: Drive, ohms: f64) -> Reading {
    match drive {
        Drive::Voltage {
            volts,
            limit_a,
            source_ohm,
        } => {
            let amps = match volts {
                0.0 => 0.0,
                volts => (volts / (ohms + source_ohm)).clamp(-limit_a, limit_a),
            };
            let volts = match amps {
                0.0 => volts,
                amps => amps * ohms,
            };
            Reading { volts, amps }
        }
        Drive::Current { amps: 0.0, .. } => Reading::default(),
        Drive::Current { amps, limit_v } => match (amps * ohms).abs() <= limit_v {
            true => Reading {
                volts: amps * ohms,
                amps,
            },
            false => Reading {
                volts: limit_v.copysign(amps),
                amps: limit_v.copysign(amps) / ohms,
            },
        },
        Drive::Open | Drive::Sine { .. } | Drive::Pulses(_) => Reading::default(),
    }
}
