//! A passive circuit: a resistor, an open or a short between each pair of terminals, and a load on the line.

use super::circuit::{Circuit, Drive, Reading, Terminal, over_resistor};
use super::line::Line;
use super::sources::Sources;

/// Voltage that the clamp never passes, volts; the next number is the range below it in which the clamp begins to
/// conduct.
const CLAMP_V: f64 = 10.0;
const SOFT_V: f64 = 1.0;

/// Returns the voltage behind the clamp: exact up to 9 V, then bent towards 10 V.
pub fn clamped(volts: f64) -> f64 {
    let over_v = volts.abs() - (CLAMP_V - SOFT_V);
    match over_v > 0.0 {
        true => (CLAMP_V - SOFT_V * (-over_v / SOFT_V).exp()).copysign(volts),
        false => volts,
    }
}

/// One resistance at the input, one at the output, one in the load circuit.
pub struct Passive {
    input_ohm: f64,
    output_ohm: f64,
    load_ohm: f64,
    sources: Sources,
}

impl Passive {
    /// Creates a circuit; infinity means open, 0 a short.
    pub fn new(input_ohm: f64, output_ohm: f64, load_ohm: f64, line: Line) -> Self {
        Self {
            input_ohm,
            output_ohm,
            load_ohm,
            sources: Sources::new(line),
        }
    }

    /// Returns voltage and current at the output while the line feeds it; an open output has the full line voltage.
    fn fed_by_line(&self) -> Reading {
        let line_v = self.sources.line.volts(0.0);
        let amps = line_v / (self.load_ohm + self.output_ohm);
        let volts = match self.output_ohm.is_finite() {
            true => amps * self.output_ohm,
            false => line_v,
        };
        Reading { volts, amps }
    }
}

impl Circuit for Passive {
    fn advance(&mut self, t_us: u64) {
        self.sources.advance(t_us);
    }

    fn drive(&mut self, terminal: Terminal, drive: Drive) {
        self.sources.connect(terminal, drive);
    }

    fn at(&self, terminal: Terminal) -> Reading {
        let line_v = self.sources.line.volts(0.0);
        let fed = self.fed_by_line();
        match terminal {
            Terminal::Input | Terminal::Pulse => {
                over_resistor(self.sources.at_input(), self.input_ohm)
            }
            Terminal::Output | Terminal::Socket => match self.sources.output {
                Drive::Open => fed,
                drive => over_resistor(drive, self.output_ohm),
            },
            Terminal::Clamped => Reading {
                volts: clamped(fed.volts),
                ..fed
            },
            Terminal::Line => Reading {
                volts: line_v,
                ..fed
            },
            Terminal::Load | Terminal::Shunt => Reading {
                volts: line_v - fed.volts,
                ..fed
            },
        }
    }

    fn line_deg(&self) -> f64 {
        self.sources.line.phase_deg()
    }
}
