//! Assignment of signals to terminals, by module and channel.

use std::collections::BTreeMap;

use super::signal::{Gate, In, Out, Quantity, Sensor, Source};
use crate::config::{RigFile, Terminal};

/// A signal at a terminal.
#[derive(Debug, Clone, Copy)]
pub struct Wire<S> {
    /// Signal of this terminal.
    pub signal: S,
    /// True when the terminal reads 0 while the signal is present.
    pub active_low: bool,
    /// For an input, volts at the terminal per unit of the quantity; for an output, units of the quantity per volt.
    pub gain: f64,
}

/// Signals of one kind, by module and channel.
pub type Terminals<S> = BTreeMap<String, Vec<(u8, Wire<S>)>>;

/// Signals at all terminals of the rig.
#[derive(Debug, Clone)]
pub struct Wiring {
    /// Digital inputs.
    pub inputs: Terminals<In>,
    /// Digital outputs.
    pub outputs: Terminals<Out>,
    /// Analog inputs.
    pub quantities: Terminals<Quantity>,
    /// RTD inputs.
    pub sensors: Terminals<Sensor>,
    /// Analog outputs.
    pub sources: Terminals<Source>,
    /// Counter gates.
    pub gates: Terminals<Gate>,
}

impl Wiring {
    /// Resolves every named point; ignores points with names that this rig does not have.
    pub fn new(rig: &RigFile) -> Self {
        Self {
            inputs: terminals(&rig.digital_in, In::from_name),
            outputs: terminals(&rig.digital_out, Out::from_name),
            quantities: terminals(&rig.analog_in, Quantity::from_name),
            sensors: terminals(&rig.temperature, Sensor::from_name),
            sources: terminals(&rig.analog_out, Source::from_name),
            gates: terminals(&rig.counter, Gate::from_name),
        }
    }
}

/// Returns the signal at one terminal.
pub fn at<S: Copy>(terminals: &Terminals<S>, module: &str, channel: u8) -> Option<Wire<S>> {
    on(terminals, module)
        .iter()
        .find(|(c, _)| *c == channel)
        .map(|(_, wire)| *wire)
}

/// Returns the signals at the terminals of one module.
pub fn on<'a, S>(terminals: &'a Terminals<S>, module: &str) -> &'a [(u8, Wire<S>)] {
    terminals.get(module).map_or(&[], Vec::as_slice)
}

/// Resolves named points; ignores names without a signal.
pub fn terminals<S>(
    points: &BTreeMap<String, Terminal>,
    named: impl Fn(&str) -> Option<S>,
) -> Terminals<S> {
    let mut all: Terminals<S> = BTreeMap::new();
    for (name, t) in points {
        if let Some(signal) = named(name) {
            let wire = Wire {
                signal,
                active_low: t.active_low,
                gain: t.gain,
            };
            all.entry(t.module.clone())
                .or_default()
                .push((t.channel, wire));
        }
    }
    all
}
