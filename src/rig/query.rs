//! Which command asks for which point.

use super::model::{Model, Terminals};
use super::point::{AnalogIn, AnalogOut, Counter, DigitalIn, Temperature};
use super::wiring::{AnalogTerminal, Module, ModuleId, Terminal, Wiring};
use crate::dcon::{self, Channel, Command, DataFormat, Digital, InputForm, OutputForm, UpTo};

impl Module {
    /// How its readings are printed; `None` unless it measures.
    pub fn input_form(&self) -> Option<InputForm> {
        let format = self.format?;
        if self.model.channels(Terminals::AnalogIn) > 0 {
            Some(InputForm::eight(format, self.type_code))
        } else if self.model.channels(Terminals::Temperature) > 0 {
            Some(InputForm::three(format, self.type_code))
        } else {
            None
        }
    }

    /// How its levels are written; `None` unless it has an analog output.
    pub fn output_form(&self) -> Option<OutputForm> {
        if self.model.channels(Terminals::AnalogOut) == 0 {
            return None;
        }
        Some(match self.format? {
            DataFormat::Engineering => OutputForm::Engineering,
            DataFormat::Percent => OutputForm::Percent,
            DataFormat::Hex if self.model == Model::I7021P => OutputForm::Hex16,
            DataFormat::Hex => OutputForm::Hex12,
        })
    }

    /// The only enabled channel of an analog input module, when there is only one.
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
    /// The read that refreshes what the image knows of a module: all inputs or outputs, all readings (the one
    /// enabled channel, if only one is), the present level, counter 0.
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
                channel: None,
                form,
            }
            .to(module.address);
        }
        if module.model.channels(Terminals::Counter) > 0 {
            return dcon::Counter::Read(counter_number(Counter::Gate0)).to(module.address);
        }
        Digital::ReadPort.to(module.address)
    }

    /// Reads one analog input.
    pub fn read_analog(&self, point: AnalogIn) -> Command {
        self.read_one(self.analog_in(point))
    }

    /// Reads one thermometer.
    pub fn read_temperature(&self, point: Temperature) -> Command {
        self.read_one(self.temperature(point))
    }

    /// Where an analog output is now, in the middle of a ramp too.
    pub fn read_supply(&self, point: AnalogOut) -> Command {
        self.poll(self.analog_out(point).module)
    }

    /// Reads a gated counter.
    pub fn read_counter(&self, point: Counter) -> Command {
        let terminal = self.counter(point);
        let number = UpTo::new(terminal.channel.get()).unwrap_or(counter_number(point));
        dcon::Counter::Read(number).to(self.module(terminal.module).address)
    }

    /// Reads the event counter of a digital input.
    pub fn read_events(&self, point: DigitalIn) -> Command {
        let Terminal {
            module, channel, ..
        } = self.digital_in(point);
        Digital::ReadEvents { channel }.to(self.module(module).address)
    }

    /// Clears the event counter of a digital input. Prefer differences modulo 65536.
    pub fn clear_events(&self, point: DigitalIn) -> Command {
        let Terminal {
            module, channel, ..
        } = self.digital_in(point);
        Digital::ClearEvents { channel }.to(self.module(module).address)
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

fn counter_number(point: Counter) -> UpTo<1> {
    const FIRST: UpTo<1> = UpTo::<1>::new(0).expect("0 is a counter");
    const SECOND: UpTo<1> = UpTo::<1>::new(1).expect("1 is a counter");
    match point {
        Counter::Gate0 => FIRST,
        Counter::Gate1 => SECOND,
    }
}
