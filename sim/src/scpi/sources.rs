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
    pulse: Drive,
    pulse_from_us: u64,
}

impl Sources {
    /// Creates terminals without sources.
    pub fn new(line: Line) -> Self {
        Self {
            line,
            output: Drive::Open,
            now_us: 0,
            input: Drive::Open,
            pulse: Drive::Open,
            pulse_from_us: 0,
        }
    }

    /// Advances to `to_us`.
    pub fn advance(&mut self, to_us: u64) {
        self.now_us = to_us;
        self.line.advance(to_us);
    }

    /// Connects a source from the present instant on.
    pub fn connect(&mut self, terminal: Terminal, drive: Drive) {
        match terminal {
            Terminal::Input => self.input = drive,
            Terminal::Pulse => {
                self.pulse = drive;
                self.pulse_from_us = self.now_us;
            }
            Terminal::Output => self.output = drive,
            Terminal::Line => self.line.drive(drive, self.now_us),
            Terminal::Load | Terminal::Clamped => {}
        }
    }

    /// Returns the source at the input: the source-measure unit, or the pulse source while the unit's output is off.
    pub fn at_input(&self) -> Drive {
        match (self.input, self.pulse) {
            (Drive::Open, Drive::Pulses(pulses)) => Drive::Voltage {
                volts: pulses.volts(self.pulsed_us()),
                limit_a: f64::INFINITY,
                source_ohm: pulses.source_ohm,
            },
            (Drive::Open, pulse) => pulse,
            (unit, _) => unit,
        }
    }

    /// Returns the time to the next edge of the pulses, at least 1 microsecond; `None` without a further edge.
    pub fn edge_us(&self) -> Option<u64> {
        let Drive::Pulses(pulses) = self.pulse else {
            return None;
        };
        let (edge_us, _) = pulses.edge_us(self.pulsed_us())?;
        Some((edge_us.ceil() as u64).max(1))
    }

    fn pulsed_us(&self) -> f64 {
        (self.now_us - self.pulse_from_us) as f64
    }
}
