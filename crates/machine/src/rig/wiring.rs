//! The wiring of the rig: every name of `config/rig.toml` resolved to line, module and channel.
//!
//! Only a checked [`Wiring`] exists (see [`super::resolve`]): every point has its own terminal on a suitable module,
//! no two modules of a line share an address, and the reaction to the emergency stop is as short as the plant demands.

use super::handling::Handling;
use super::instruments::InstrumentWiring;
use super::interlock::StrokeNeeds;
use super::model::Model;
use super::point::{
    AnalogInput, AnalogOutput, DigitalIn, DigitalInput, DigitalOut, DigitalOutput, GatedCounter,
    Quantity, Switch, Thermometer,
};
use super::settings::{BusSettings, SafetySettings};
use super::supply::SupplyRange;
use dcon::{Address, Channel, DataFormat, SlewCode, TypeCode};
use std::collections::BTreeSet;

/// Index of a line in [`Wiring::lines`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct LineId(pub usize);

/// Index of a module in [`Wiring::modules`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ModuleId(pub usize);

/// One RS-485 line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Line {
    /// Name in `config/rig.toml`.
    pub name: String,
    /// Path of the serial port.
    pub port: String,
    /// Bits per second.
    pub baud: u32,
    /// True when its modules use checksums.
    pub checksum: bool,
}

/// One module, with the configuration that it must have at start.
#[derive(Debug, Clone, PartialEq)]
pub struct Module {
    /// Name in `config/rig.toml`.
    pub name: String,
    /// Line of the module.
    pub line: LineId,
    /// Address on that line.
    pub address: Address,
    /// Model of the module.
    pub model: Model,
    /// Type code TT of the configuration word.
    pub type_code: TypeCode,
    /// Data format; `None` for modules without analog data.
    pub format: Option<DataFormat>,
    /// Fast mode of an analog input module.
    pub fast: bool,
    /// Enabled channels of an analog input module, bit n = channel n.
    pub mask: Option<u8>,
    /// Slew code of an analog output module.
    pub slew: Option<SlewCode>,
    /// True when the host watchdog must be on.
    pub watchdog: bool,
    /// Safe value of an analog output, V at the terminal.
    pub safe_volts: f64,
    /// Safe value of its digital outputs.
    pub safe_outputs: u16,
}

/// Terminal of a digital point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Terminal {
    /// The module.
    pub module: ModuleId,
    /// Channel, from 0.
    pub channel: Channel,
    /// True when the bit reads 0 while the signal is present.
    pub active_low: bool,
}

impl Terminal {
    /// Returns the signal in the bits of this module.
    pub fn read(self, bits: u16) -> bool {
        (bits & self.bit() != 0) != self.active_low
    }

    /// Returns the bit of this channel.
    pub fn bit(self) -> u16 {
        1 << self.channel.get()
    }
}

/// Terminal of an analog point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AnalogTerminal {
    /// The module.
    pub module: ModuleId,
    /// Channel, from 0.
    pub channel: Channel,
    /// Inputs: volts at the terminal per unit of the quantity. Outputs: volts of the coil supply per
    /// volt at the terminal. Thermometers and counters: 1.
    pub gain: f64,
}

/// The resolved and checked rig; constant while the program runs.
#[derive(Debug, Clone)]
pub struct Wiring {
    /// Lines in alphabetical order.
    pub lines: Vec<Line>,
    /// Modules by line and address.
    pub modules: Vec<Module>,
    /// SCPI instruments in alphabetical order.
    pub instruments: Vec<InstrumentWiring>,
    /// Times and counts that hold for every line.
    pub bus: BusSettings,
    /// Demands of the plant on the emergency stop.
    pub safety: SafetySettings,
    /// Strokes that need an input.
    pub interlocks: Vec<StrokeNeeds>,
    /// How parts get to their test.
    pub handling: Handling,
    /// Ranges of the coil supply, smallest first; empty on a rig without a source in `[analog_out]`.
    pub supply_ranges: Vec<SupplyRange>,
    /// Range for which the gains hold; `None` for the gains of `config/rig.toml`, at factor 1.
    pub supply_range: Option<SupplyRange>,
    /// Inputs of the machine, then those of the fixtures, then beams or contacts of sockets. An input that only the
    /// other handling (feeder or rack) needs has no terminal.
    pub(super) digital_in: Vec<(String, Option<Terminal>)>,
    /// Outputs of the machine, then of the fixtures. An output that only the other handling needs has no terminal.
    pub(super) digital_out: Vec<(Switch, Option<Terminal>)>,
    pub(super) analog_in: Vec<(Quantity, AnalogTerminal)>,
    pub(super) analog_out: Vec<(&'static str, AnalogTerminal)>,
    pub(super) temperature: Vec<(&'static str, AnalogTerminal)>,
    pub(super) counter: Vec<(&'static str, AnalogTerminal)>,
    /// Index of the first beam or contact of a socket in `digital_in`: the inputs before it are those of machine and
    /// fixtures.
    pub(super) before_beams: usize,
}

fn named<'a>(mut names: impl Iterator<Item = &'a str>, name: &str) -> Option<usize> {
    names.position(|known| known == name)
}

impl Wiring {
    /// Returns the line with this index.
    pub fn line(&self, line: LineId) -> &Line {
        &self.lines[line.0]
    }

    /// Returns the module with this index.
    pub fn module(&self, module: ModuleId) -> &Module {
        &self.modules[module.0]
    }

    /// Returns the line with this name.
    pub fn line_named(&self, name: &str) -> Option<LineId> {
        self.lines
            .iter()
            .position(|line| line.name == name)
            .map(LineId)
    }

    /// Returns the module at an address of a line.
    pub fn at(&self, line: LineId, address: Address) -> Option<ModuleId> {
        let here = |module: &Module| module.line == line && module.address == address;
        self.modules.iter().position(here).map(ModuleId)
    }

    /// Yields every line.
    pub fn line_ids(&self) -> impl Iterator<Item = LineId> + use<> {
        (0..self.lines.len()).map(LineId)
    }

    /// Yields every module.
    pub fn module_ids(&self) -> impl Iterator<Item = ModuleId> + use<> {
        (0..self.modules.len()).map(ModuleId)
    }

    /// Yields the modules of a line, by address.
    pub fn modules_on(&self, line: LineId) -> impl Iterator<Item = ModuleId> {
        self.module_ids()
            .filter(move |module| self.module(*module).line == line)
    }

    /// Returns the terminal of a digital input.
    ///
    /// # Panics
    /// Panics for an input that only the other handling has.
    pub fn digital_in(&self, point: impl Into<DigitalInput>) -> Terminal {
        let point = point.into();
        let Some(terminal) = self.wired_in(point) else {
            panic!("{} is not wired", self.input_name(point))
        };
        terminal
    }

    /// Returns the terminal of a digital input; `None` for one that only the other handling has.
    pub fn wired_in(&self, point: impl Into<DigitalInput>) -> Option<Terminal> {
        self.digital_in[point.into().index()].1
    }

    /// Returns the terminal of a digital output.
    ///
    /// # Panics
    /// Panics for an output that only the other handling has.
    pub fn digital_out(&self, point: impl Into<DigitalOutput>) -> Terminal {
        let point = point.into();
        let Some(terminal) = self.wired_out(point) else {
            panic!("{} is not wired", self.switch(point).name)
        };
        terminal
    }

    /// Returns the terminal of a digital output; `None` for one that only the other handling has.
    pub fn wired_out(&self, point: impl Into<DigitalOutput>) -> Option<Terminal> {
        self.digital_out[point.into().index()].1
    }

    /// Returns the terminal of an analog input.
    pub fn analog_in(&self, point: AnalogInput) -> AnalogTerminal {
        self.analog_in[point.index()].1
    }

    /// Returns the terminal of an analog output.
    pub fn analog_out(&self, point: AnalogOutput) -> AnalogTerminal {
        self.analog_out[point.index()].1
    }

    /// Returns the terminal of a thermometer.
    pub fn temperature(&self, point: Thermometer) -> AnalogTerminal {
        self.temperature[point.index()].1
    }

    /// Returns the terminal of a counter.
    pub fn counter(&self, point: GatedCounter) -> AnalogTerminal {
        self.counter[point.index()].1
    }

    /// Returns name and trace flag of an output.
    pub fn switch(&self, point: DigitalOutput) -> Switch {
        self.digital_out[point.index()].0
    }

    /// Returns the quantity of an analog input.
    pub fn quantity(&self, point: AnalogInput) -> Quantity {
        self.analog_in[point.index()].0
    }

    /// Returns the name of a digital input.
    pub fn input_name(&self, point: impl Into<DigitalInput>) -> &str {
        &self.digital_in[point.into().index()].0
    }

    /// Returns the name of a thermometer.
    pub fn thermometer_name(&self, point: Thermometer) -> &'static str {
        self.temperature[point.index()].0
    }

    /// Returns the name of an analog output.
    pub fn source_name(&self, point: AnalogOutput) -> &'static str {
        self.analog_out[point.index()].0
    }

    /// Returns the name of a counter.
    pub fn counter_name(&self, point: GatedCounter) -> &'static str {
        self.counter[point.index()].0
    }

    /// Returns the digital input with this name; `None` when the rig lacks it.
    pub fn digital_input(&self, name: &str) -> Option<DigitalInput> {
        let at = named(self.digital_in.iter().map(|it| it.0.as_str()), name)?;
        self.digital_in[at].1.map(|_| DigitalInput::at(at))
    }

    /// Returns the digital output with this name; `None` when the rig lacks it.
    pub fn digital_output(&self, name: &str) -> Option<DigitalOutput> {
        let at = named(self.digital_out.iter().map(|it| it.0.name), name)?;
        self.digital_out[at].1.map(|_| DigitalOutput::at(at))
    }

    /// Returns the analog input with this name; `None` when the rig lacks it.
    pub fn analog_input(&self, name: &str) -> Option<AnalogInput> {
        named(self.analog_in.iter().map(|it| it.0.name), name).map(AnalogInput::at)
    }

    /// Returns the analog output with this name; `None` when the rig lacks it.
    pub fn analog_output(&self, name: &str) -> Option<AnalogOutput> {
        named(self.analog_out.iter().map(|it| it.0), name).map(AnalogOutput::at)
    }

    /// Returns the thermometer with this name; `None` when the rig lacks it.
    pub fn thermometer(&self, name: &str) -> Option<Thermometer> {
        named(self.temperature.iter().map(|it| it.0), name).map(Thermometer::at)
    }

    /// Returns the counter with this name; `None` when the rig lacks it.
    pub fn gated_counter(&self, name: &str) -> Option<GatedCounter> {
        named(self.counter.iter().map(|it| it.0), name).map(GatedCounter::at)
    }

    /// Yields every wired digital input with its name, in the order in which pages show them: fixtures, machine, beams
    /// or sockets.
    pub fn digital_inputs(&self) -> impl Iterator<Item = (&str, DigitalInput)> {
        let (machine, all) = (DigitalIn::COUNT, self.digital_in.len());
        (machine..self.before_beams)
            .chain(0..machine)
            .chain(self.before_beams..all)
            .filter(|at| self.digital_in[*at].1.is_some())
            .map(|at| (self.digital_in[at].0.as_str(), DigitalInput::at(at)))
    }

    /// Yields every wired digital input of the fixtures.
    pub(super) fn fixture_inputs(&self) -> impl Iterator<Item = DigitalInput> {
        (DigitalIn::COUNT..self.before_beams)
            .filter(|at| self.digital_in[*at].1.is_some())
            .map(DigitalInput::at)
    }

    /// Yields every wired digital output with its name, in the order in which pages show them: fixtures, machine.
    pub fn digital_outputs(&self) -> impl Iterator<Item = (&'static str, DigitalOutput)> {
        let machine = DigitalOut::COUNT;
        (machine..self.digital_out.len())
            .chain(0..machine)
            .filter(|at| self.digital_out[*at].1.is_some())
            .map(|at| (self.digital_out[at].0.name, DigitalOutput::at(at)))
    }

    /// Yields name and state of every digital signal of a module; bit n of `bits` is the level of channel n.
    pub fn signals(&self, module: ModuleId, bits: u16) -> impl Iterator<Item = (&str, bool)> {
        let inputs = self.digital_in.iter().map(|it| (it.0.as_str(), it.1));
        let outputs = self.digital_out.iter().map(|it| (it.0.name, it.1));
        let own =
            move |it: (_, Option<Terminal>)| Some((it.0, it.1.filter(|it| it.module == module)?));
        let all = inputs.chain(outputs).filter_map(own);
        all.map(move |(name, terminal)| (name, terminal.read(bits)))
    }

    /// Returns the lines that have points of a fixture, and on which measuring jobs therefore run; in order, each once.
    pub fn measuring_lines(&self) -> Vec<LineId> {
        let inputs = self.digital_in[DigitalIn::COUNT..self.before_beams].iter();
        let outputs = self.digital_out[DigitalOut::COUNT..].iter();
        let digital = inputs
            .map(|it| it.1)
            .chain(outputs.map(|it| it.1))
            .flatten()
            .map(|it| it.module);
        let analog = self.analog_in.iter().map(|it| it.1.module);
        let other = [&self.analog_out, &self.temperature, &self.counter];
        let other = other.into_iter().flatten().map(|it| it.1.module);
        let modules = digital.chain(analog).chain(other);
        let lines: BTreeSet<LineId> = modules.map(|it| self.module(it).line).collect();
        lines.into_iter().collect()
    }

    /// Returns the module with the emergency-stop contact; every second transaction of its line reads it.
    pub fn emergency_stop_module(&self) -> ModuleId {
        self.digital_in(DigitalIn::EmergencyStopOk).module
    }

    /// Returns how often a line tries a repeatable command. The line of the emergency stop tries it once, because a
    /// repetition would delay the next read of the contact, and the next scan repeats the command anyway.
    pub fn tries_on(&self, line: LineId) -> u8 {
        if self.module(self.emergency_stop_module()).line == line {
            1
        } else {
            self.bus.tries
        }
    }
}
