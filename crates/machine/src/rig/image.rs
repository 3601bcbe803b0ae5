//! The process image: the last values of each module, with their times.
//!
//! The image contains no guesses. A point that was never read, or was read too long ago, has no value; after a reset of
//! its module ([`Image::forget`]) a point has none until the next read. The time of a value is that of its request, so
//! that no age is understated.

use super::point::{AnalogInput, DigitalIn, DigitalInput, GatedCounter, Thermometer};
use super::sample::{AnalogPoint, CountPoint, CountSample, Origin, Quality, Sample};
use super::wiring::{LineId, Module, ModuleId, Wiring};
use dcon::{Address, Channel, Command, Common, Digital, Reading, Reply, Unit, Value};
use std::sync::{Arc, OnceLock};
use thiserror::Error;
use units::{RigTime, Span};

/// An answer that does not fit this rig.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum Unexpected {
    /// The wiring has no module at this address.
    #[error("line {line}: an answer from address {address}, where no module is wired")]
    UnknownAddress {
        /// Name of the line.
        line: String,
        /// The requested address.
        address: Address,
    },
    /// The decoded reply does not fit its command.
    #[error("line {line}, address {address}: the reply does not belong to its command")]
    WrongReply {
        /// Name of the line.
        line: String,
        /// The requested address.
        address: Address,
    },
}

/// Bits of a digital module, with the time of their request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Word {
    bits: u16,
    at: RigTime,
}

/// All known values of the rig.
#[derive(Debug, Clone)]
pub struct Image {
    wiring: Arc<Wiring>,
    words: Vec<Option<Word>>,
    analog: Vec<Option<Sample>>,
    temperatures: Vec<Option<Sample>>,
    counters: Vec<Option<CountSample>>,
    events: Vec<Option<CountSample>>,
    levels: Vec<Option<(f64, RigTime)>>,
    resets: Vec<ModuleId>,
    /// [`Wiring::emergency_stop_max_age`], which every turn needs.
    emergency_stop_max_age: OnceLock<Span>,
}

impl Image {
    /// Makes an image without values.
    pub fn new(wiring: Arc<Wiring>) -> Self {
        let modules = wiring.modules.len();
        Self {
            words: vec![None; modules],
            analog: vec![None; wiring.analog_in.len()],
            temperatures: vec![None; wiring.temperature.len()],
            counters: vec![None; wiring.counter.len()],
            events: vec![None; wiring.digital_in.len()],
            levels: vec![None; modules],
            resets: Vec::new(),
            emergency_stop_max_age: OnceLock::new(),
            wiring,
        }
    }

    /// Returns the wiring of the rig.
    pub fn wiring(&self) -> &Wiring {
        &self.wiring
    }

    /// Stores a valid reply; `at`: time of the request. Ignores replies without process values.
    ///
    /// # Errors
    /// Fails with [`Unexpected`], and then changes nothing.
    pub fn accept(
        &mut self,
        line: LineId,
        command: &Command,
        reply: &Reply,
        raw: &str,
        at: RigTime,
    ) -> Result<(), Unexpected> {
        let Some(address) = command.address() else {
            return Ok(());
        };
        let Some(module) = self.wiring.at(line, address) else {
            return Err(Unexpected::UnknownAddress {
                line: self.wiring.line(line).name.clone(),
                address,
            });
        };
        let arrival = Arrival {
            line,
            module,
            command: *command,
            raw,
            at,
        };
        if self.store(&arrival, reply) {
            return Ok(());
        }
        Err(Unexpected::WrongReply {
            line: self.wiring.line(line).name.clone(),
            address,
        })
    }

    /// Stores the reply; returns false when it does not fit its command.
    fn store(&mut self, arrival: &Arrival<'_>, reply: &Reply) -> bool {
        use dcon::AnalogIn::{ReadAll, ReadAllHex, ReadOne};
        let module = arrival.module;
        match (&arrival.command, reply) {
            (Command::AnalogIn(_, ReadAll(_) | ReadAllHex(_)), Reply::Readings(readings)) => {
                self.store_readings(arrival, |channel| readings.get(usize::from(channel.get())));
            }
            (Command::AnalogIn(_, ReadOne { channel: one, .. }), Reply::Reading(reading)) => {
                self.store_readings(arrival, |channel| (channel == *one).then_some(*reading));
            }
            (Command::Digital(_, Digital::ReadPort | Digital::ReadAll), Reply::Bits(bits)) => {
                let (bits, at) = (bits.word(), arrival.at);
                self.words[module.0] = Some(Word { bits, at });
            }
            (Command::Digital(_, Digital::ReadEvents { channel }), Reply::Events(count)) => {
                self.store_events(arrival, *channel, *count);
            }
            (Command::Counter(_, dcon::Counter::Read(number)), Reply::Count(count)) => {
                self.store_count(arrival, number.get(), *count);
            }
            (Command::AnalogOut(_, dcon::AnalogOut::ReadPresent { .. }), Reply::Level(level)) => {
                let volts = level.in_units(self.wiring.module(module).type_code);
                self.levels[module.0] = volts.map(|volts| (volts, arrival.at));
            }
            (Command::Common(_, Common::ReadResetStatus), Reply::Flag(was_reset)) => {
                if *was_reset {
                    self.forget(module);
                    self.resets.push(module);
                }
            }
            (
                Command::AnalogIn(_, ReadAll(_) | ReadAllHex(_) | ReadOne { .. })
                | Command::Digital(
                    _,
                    Digital::ReadPort | Digital::ReadAll | Digital::ReadEvents { .. },
                )
                | Command::Counter(_, dcon::Counter::Read(_))
                | Command::AnalogOut(_, dcon::AnalogOut::ReadPresent { .. })
                | Command::Common(_, Common::ReadResetStatus),
                _,
            ) => return false,
            (
                Command::HostOk
                | Command::SampleAll
                | Command::Common(..)
                | Command::AnalogIn(..)
                | Command::AnalogOut(..)
                | Command::Digital(..)
                | Command::Counter(..),
                _,
            ) => {}
        }
        true
    }

    fn store_readings(
        &mut self,
        arrival: &Arrival<'_>,
        reading: impl Fn(Channel) -> Option<Reading>,
    ) {
        let wiring = Arc::clone(&self.wiring);
        let module = wiring.module(arrival.module);
        let raw: Arc<str> = Arc::from(arrival.raw);
        for (index, (_, terminal)) in wiring.analog_in.iter().enumerate() {
            if terminal.module == arrival.module
                && let Some(reading) = reading(terminal.channel)
            {
                let origin = arrival.origin(terminal.channel, &raw);
                let point = AnalogPoint::Input(AnalogInput::at(index));
                self.analog[index] = Some(sample(point, &reading, module, terminal.gain, origin));
            }
        }
        for (index, (_, terminal)) in wiring.temperature.iter().enumerate() {
            if terminal.module == arrival.module
                && let Some(reading) = reading(terminal.channel)
            {
                let origin = arrival.origin(terminal.channel, &raw);
                let point = AnalogPoint::Temperature(Thermometer::at(index));
                self.temperatures[index] = Some(sample(point, &reading, module, 1.0, origin));
            }
        }
    }

    fn store_events(&mut self, arrival: &Arrival<'_>, channel: Channel, count: u16) {
        let mut terminals = self.wiring.digital_in.iter().map(|(_, terminal)| terminal);
        let here = terminals.position(|it| {
            it.is_some_and(|it| it.module == arrival.module && it.channel == channel)
        });
        if let Some(index) = here {
            let origin = arrival.origin(channel, &Arc::from(arrival.raw));
            self.events[index] = Some(CountSample {
                point: CountPoint::Events(DigitalInput::at(index)),
                count: u32::from(count),
                origin,
            });
        }
    }

    fn store_count(&mut self, arrival: &Arrival<'_>, number: u8, count: u32) {
        for (index, (_, terminal)) in self.wiring.counter.iter().enumerate() {
            if terminal.module == arrival.module && terminal.channel.get() == number {
                let origin = arrival.origin(terminal.channel, &Arc::from(arrival.raw));
                self.counters[index] = Some(CountSample {
                    point: CountPoint::Gate(GatedCounter::at(index)),
                    count,
                    origin,
                });
            }
        }
    }

    /// Drops all values of a module that was reset.
    pub fn forget(&mut self, module: ModuleId) {
        self.words[module.0] = None;
        self.levels[module.0] = None;
        for sample in self.analog.iter_mut().chain(&mut self.temperatures) {
            sample.take_if(|sample| sample.origin.module == module);
        }
        for sample in self.counters.iter_mut().chain(&mut self.events) {
            sample.take_if(|sample| sample.origin.module == module);
        }
    }

    /// Returns the modules that reported a reset (`$AA5` = 1) since the last call; their outputs have the power-on
    /// value.
    pub fn take_resets(&mut self) -> Vec<ModuleId> {
        std::mem::take(&mut self.resets)
    }

    /// Returns the state of an input that was just requested; `None` when its value is too old to be the answer to that
    /// request ([`Wiring::answer_max_age`]).
    pub fn answered_input(&self, point: impl Into<DigitalInput>, now: RigTime) -> Option<bool> {
        let point = point.into();
        let line = self
            .wiring
            .module(self.wiring.digital_in(point).module)
            .line;
        self.input(point, now, self.wiring.answer_max_age(line))
    }

    /// Returns the state of a digital input; `None` if it was never read, or if the request that read it is older than
    /// `max_age`.
    pub fn input(
        &self,
        point: impl Into<DigitalInput>,
        now: RigTime,
        max_age: Span,
    ) -> Option<bool> {
        let terminal = self.wiring.wired_in(point)?;
        let word = self.words[terminal.module.0]?;
        let fresh = word.at <= now && now.since(word.at) <= max_age;
        let model = self.wiring.module(terminal.module).model;
        fresh.then(|| terminal.read(model.input_bits(word.bits)))
    }

    /// Returns the state of the emergency-stop contact; `None` once the value is so old that the contact counts as
    /// open.
    pub fn emergency_stop_ok(&self, now: RigTime) -> Option<bool> {
        self.input(
            DigitalIn::EmergencyStopOk,
            now,
            self.emergency_stop_max_age(),
        )
    }

    /// Returns the time at which the state of the emergency-stop contact expires unless it is read again; `None` if it
    /// was never read.
    pub fn emergency_stop_known_until(&self) -> Option<RigTime> {
        let requested = self.input_at(DigitalIn::EmergencyStopOk)?;
        Some(requested + self.emergency_stop_max_age())
    }

    fn emergency_stop_max_age(&self) -> Span {
        let derived = || self.wiring.emergency_stop_max_age();
        *self.emergency_stop_max_age.get_or_init(derived)
    }

    /// Returns the time of the last answered request for a digital input; `None` without a value.
    pub fn input_at(&self, point: impl Into<DigitalInput>) -> Option<RigTime> {
        self.words[self.wiring.wired_in(point)?.module.0].map(|word| word.at)
    }

    /// Returns the last bits of a digital module, and the time of their request.
    pub fn word(&self, module: ModuleId) -> Option<(u16, RigTime)> {
        self.words[module.0].map(|word| (word.bits, word.at))
    }

    /// Returns the last sample of an analog input, of any age.
    pub fn analog(&self, point: AnalogInput) -> Option<&Sample> {
        self.analog[point.index()].as_ref()
    }

    /// Returns the last sample of a thermometer, of any age.
    pub fn temperature(&self, point: Thermometer) -> Option<&Sample> {
        self.temperatures[point.index()].as_ref()
    }

    /// Returns the last sample of a gated counter, of any age.
    pub fn counter(&self, point: GatedCounter) -> Option<&CountSample> {
        self.counters[point.index()].as_ref()
    }

    /// Returns the last event count of a digital input, of any age.
    pub fn events(&self, point: impl Into<DigitalInput>) -> Option<&CountSample> {
        self.events[point.into().index()].as_ref()
    }

    /// Returns the last reported level of an analog output, V at its terminal, and the time of the request.
    pub fn level(&self, module: ModuleId) -> Option<(f64, RigTime)> {
        self.levels[module.0]
    }
}

struct Arrival<'a> {
    line: LineId,
    module: ModuleId,
    command: Command,
    raw: &'a str,
    at: RigTime,
}

impl Arrival<'_> {
    fn origin(&self, channel: Channel, raw: &Arc<str>) -> Origin {
        Origin {
            line: self.line,
            module: self.module,
            channel,
            command: self.command,
            raw: Arc::clone(raw),
            at: self.at,
        }
    }
}

fn sample(
    point: AnalogPoint,
    reading: &Reading,
    module: &Module,
    gain: f64,
    origin: Origin,
) -> Sample {
    let quality = match reading.value {
        Value::Engineering(_) | Value::Percent(_) | Value::Hex(_) | Value::HexUnipolar(_) => {
            Quality::Good
        }
        Value::OverRange => Quality::OverRange,
        Value::UnderRange => Quality::UnderRange,
        Value::Blank => Quality::Blank,
    };
    let scale = match module.type_code.full_scale().map(|scale| scale.unit) {
        Some(Unit::Millivolt) => 1e-3,
        Some(Unit::Volt | Unit::Celsius | Unit::Milliampere) | None => 1.0,
    };
    let terminal_volts = reading
        .value
        .in_units(module.type_code)
        .map_or(f64::NAN, |value| value * scale);
    Sample {
        point,
        value: terminal_volts / gain,
        terminal_volts,
        quality,
        origin,
    }
}
