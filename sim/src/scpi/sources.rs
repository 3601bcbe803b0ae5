//! Sources at all terminals of a circuit, as they are at the present instant.

use super::circuit::{Drive, Terminal};
use super::line::Line;

/// Sources at the terminals of a circuit, with its line.
pub struct Sources {
    /// Line of the load circuit.
    pub line: Line,
    /// Source at the output of the part.
    pub output: Drive,
    /// Present instant, microseconds.
    pub now_us: u64,
    input: Drive,
    pulse: PulseInput,
}

/// Pulse source at an input, with the instant of its first edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PulseInput {
    drive: Drive,
    from_us: f64,
}

impl Default for PulseInput {
    fn default() -> Self {
        Self {
            drive: Drive::Open,
            from_us: 0.0,
        }
    }
}

impl PulseInput {
    /// Connects a source at `now_us`.
    pub fn new(drive: Drive, now_us: f64) -> Self {
        let delay_us = match drive {
            Drive::Pulses(pulses) => pulses.delay_us,
            Drive::Open | Drive::Voltage { .. } | Drive::Current { .. } | Drive::Sine { .. } => 0.0,
        };
        Self {
            drive,
            from_us: now_us + delay_us,
        }
    }

    /// Returns the source with its present level.
    pub fn at(&self, now_us: f64) -> Drive {
        match self.drive {
            Drive::Pulses(pulses) => Drive::Voltage {
                volts: pulses.volts(now_us - self.from_us),
                limit_a: f64::INFINITY,
                source_ohm: pulses.source_ohm,
            },
            other => other,
        }
    }

    /// Returns the time to the next edge, microseconds; `None` without a further edge.
    pub fn edge_us(&self, now_us: f64) -> Option<f64> {
        let Drive::Pulses(pulses) = self.drive else {
            return None;
        };
        let (edge_us, _) = pulses.edge_us(now_us - self.from_us)?;
        Some(edge_us)
    }
}

impl Sources {
    /// Creates terminals without sources.
    pub fn new(line: Line) -> Self {
        Self {
            line,
            output: Drive::Open,
            now_us: 0,
            input: Drive::Open,
            pulse: PulseInput::default(),
        }
    }

    /// Advances to `to_us`.
    pub fn advance(&mut self, to_us: u64) {
        self.now_us = to_us;
        self.line.advance(to_us as f64);
    }

    /// Connects a source from the present instant on.
    pub fn connect(&mut self, terminal: Terminal, drive: Drive) {
        match terminal {
            Terminal::Input => self.input = drive,
            Terminal::Pulse => self.pulse = PulseInput::new(drive, self.now_us as f64),
            Terminal::Output => self.output = drive,
            Terminal::Line => self.line.drive(drive, self.now_us as f64),
            Terminal::Load | Terminal::Shunt | Terminal::Clamped | Terminal::Socket => {}
        }
    }

    /// Returns the source at the input: the source-measure unit, or the pulse source while the unit's output is off.
    pub fn at_input(&self) -> Drive {
        match self.input {
            Drive::Open => self.pulse.at(self.now_us as f64),
            unit => unit,
        }
    }

    /// Returns the time to the next edge of the pulses, at least 1 microsecond; `None` without a further edge.
    pub fn edge_us(&self) -> Option<u64> {
        let edge_us = self.pulse.edge_us(self.now_us as f64)?;
        Some((edge_us.ceil() as u64).max(1))
    }
}
