//! The commands that read points.

use super::model::{Model, Terminals};
use super::point::{AnalogInput, DigitalInput, GatedCounter, Point};
use super::wiring::{AnalogTerminal, LineId, Module, ModuleId, Terminal, Wiring};
use dcon::{Channel, Command, DataFormat, Digital, InputForm, OutputForm, UpTo};
use std::collections::BTreeSet;

impl Module {
    /// Returns the format of the module's readings; `None` for a module that measures nothing.
    pub fn input_form(&self) -> Option<InputForm> {
        let format = self.format?;
        match self.model.channels(Terminals::AnalogIn) + self.model.channels(Terminals::Temperature)
        {
            8 => Some(InputForm::eight(format, self.type_code)),
            3 => Some(InputForm::three(format, self.type_code)),
            _ => None,
        }
    }

    /// Returns the format of the module's levels; `None` for a module without analog output.
    pub fn output_form(&self) -> Option<OutputForm> {
        if self.model.channels(Terminals::AnalogOut) == 0 {
            return None;
        }
        Some(match self.format? {
            DataFormat::Engineering if self.model == Model::I7024 => OutputForm::EngineeringSigned,
            DataFormat::Engineering => OutputForm::Engineering,
            DataFormat::Percent => OutputForm::Percent,
            DataFormat::Hex if self.model == Model::I7021P => OutputForm::Hex16,
            DataFormat::Hex => OutputForm::Hex12,
        })
    }

    /// Returns for each analog output the channel to name in commands; `None` on a module with a single output.
    pub fn level_channels(&self) -> Vec<Option<Channel>> {
        match self.model.channels(Terminals::AnalogOut) {
            1 => vec![None],
            several => (0..several).map(Channel::new).collect(),
        }
    }

    /// Returns the only enabled channel of an analog input module; `None` when several are.
    fn lone_channel(&self) -> Option<Channel> {
        let mask = self.mask?;
        if mask.count_ones() == 1 {
            Channel::new(mask.trailing_zeros() as u8)
        } else {
            None
        }
    }
}

impl Wiring {
    /// Returns the command that refreshes a module's values in the image: it reads all inputs or outputs, all readings
    /// (or the one enabled channel), the present level (of the first output), or counter 0.
    pub fn poll(&self, module: ModuleId) -> Command {
        let module = self.module(module);
        if let Some(form) = module.input_form() {
            return match module.lone_channel() {
                Some(channel) => dcon::AnalogIn::ReadOne { channel, form }.to(module.address),
                None => dcon::AnalogIn::ReadAll(form).to(module.address),
            };
        }
        if let Some(form) = module.output_form() {
            return dcon::AnalogOut::ReadPresent {
                channel: module.level_channels()[0],
                form,
            }
            .to(module.address);
        }
        if module.model.channels(Terminals::Counter) > 0 {
            return dcon::Counter::Read(FIRST).to(module.address);
        }
        Digital::ReadPort.to(module.address)
    }

    /// Returns the transactions that read these points, in order, each with its line: one for all digital inputs of a
    /// module, one scan for several analog channels of a module, one for each other point.
    pub fn reads(&self, points: &[Point]) -> Vec<(LineId, Command)> {
        let mut requests: Vec<(ModuleId, Command)> = Vec::new();
        for point in points {
            let one @ (module, command) = self.read(*point, points);
            let known = |it: &(ModuleId, Command)| it.0 == module && it.1 == command;
            if !requests.iter().any(known) {
                requests.push(one);
            }
        }
        let sent = |(module, command)| (self.module(module).line, command);
        requests.into_iter().map(sent).collect()
    }

    /// Returns the command that reads one point when the points `wanted` are read in the same job.
    fn read(&self, point: Point, wanted: &[Point]) -> (ModuleId, Command) {
        match point {
            Point::Input(input) => {
                let module = self.digital_in(input).module;
                (module, self.poll(module))
            }
            Point::Analog(input) => {
                let at = self.analog_in(input);
                let here = |it: &&Point| matches!(it, Point::Analog(other) if self.analog_in(*other).module == at.module);
                let command = match wanted.iter().filter(here).count() {
                    1 => self.read_one(at),
                    _ => self.scan(at.module),
                };
                (at.module, command)
            }
            Point::Temperature(point) => {
                let at = self.temperature(point);
                (at.module, self.read_one(at))
            }
            Point::Count(counter) => (self.counter(counter).module, self.read_counter(counter)),
        }
    }

    /// Returns the command that reads all enabled channels of a converter.
    fn scan(&self, module: ModuleId) -> Command {
        match self.module(module).input_form() {
            Some(form) => dcon::AnalogIn::ReadAll(form).to(self.module(module).address),
            None => self.poll(module),
        }
    }

    /// Returns the writes that enable exactly these inputs of their converters. They write EEPROM.
    pub fn masks(&self, inputs: &[AnalogInput]) -> Vec<(LineId, Command)> {
        let modules: BTreeSet<ModuleId> =
            inputs.iter().map(|it| self.analog_in(*it).module).collect();
        let write = |id: ModuleId| {
            let (module, mask) = (self.module(id), self.mask_of(id, inputs));
            (
                module.line,
                dcon::AnalogIn::WriteMask(mask).to(module.address),
            )
        };
        modules.into_iter().map(write).collect()
    }

    /// Returns the channel mask that enables exactly these inputs of one converter; 0 when it has none of them.
    pub fn mask_of(&self, module: ModuleId, inputs: &[AnalogInput]) -> u8 {
        let here = inputs.iter().map(|input| self.analog_in(*input));
        let here = here.filter(|at| at.module == module);
        here.fold(0, |mask, at| mask | 1 << at.channel.get())
    }

    fn read_counter(&self, point: GatedCounter) -> Command {
        let terminal = self.counter(point);
        let number = UpTo::new(terminal.channel.get()).unwrap_or(FIRST);
        dcon::Counter::Read(number).to(self.module(terminal.module).address)
    }

    /// Returns the command that reads a digital input's event counter.
    pub fn read_events(&self, point: impl Into<DigitalInput>) -> Command {
        let Terminal {
            module, channel, ..
        } = self.digital_in(point);
        Digital::ReadEvents { channel }.to(self.module(module).address)
    }

    fn read_one(&self, terminal: AnalogTerminal) -> Command {
        let module = self.module(terminal.module);
        match module.input_form() {
            Some(form) => dcon::AnalogIn::ReadOne {
                channel: terminal.channel,
                form,
            }
            .to(module.address),
            None => self.poll(terminal.module),
        }
    }
}

const FIRST: UpTo<1> = UpTo::<1>::new(0).expect("0 is a counter");
