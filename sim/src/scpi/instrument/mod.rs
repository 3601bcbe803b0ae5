//! Instruments: commands, measurements and their errors.
//!
//! An instrument is a table of settings and a job: a measurement that runs while time passes.

mod ac_source;
mod digitizer;
mod errors;
mod front_end;
mod multimeter;
mod pulse_source;
mod settings;
mod smu;
mod window;

use super::circuit::{Circuit, Terminal};
use super::message::Unit;
use super::status::Failure;
use crate::module::tolerances::stream;
use crate::table::{read_fields, read_words};
use digitizer::Dialect;
use errors::Errors;
use settings::{Changed, Handled, Setting, Settings};

/// Result of a command or query, with its execution time in microseconds.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// A command without reply.
    Done(u64),
    /// A text reply.
    Text(String, u64),
    /// A reply as a block.
    Block(Vec<u8>, u64),
    /// The result needs the end of the present job; [`Instrument::fetch`] then returns it.
    AfterJob,
}

/// An instant, and the circuit at this instant.
pub struct Moment<'a> {
    /// Microseconds since the bench began.
    pub now_us: u64,
    /// Circuit to which the instruments connect, advanced to `now_us`.
    pub circuit: &'a mut dyn Circuit,
}

/// An instrument behind its command interpreter.
pub trait Instrument: Send {
    /// Returns identity, settings, latency and errors.
    fn body(&mut self) -> &mut Body;

    /// Restores the settings of `*RST` and disconnects sources; returns the execution time, microseconds.
    fn reset(&mut self, at: &mut Moment<'_>) -> u64;

    /// Carries out the effect of a changed setting; returns the time that this takes in addition to the command itself,
    /// microseconds.
    ///
    /// # Errors
    /// Fails with the entry for the error queue.
    fn changed(&mut self, changed: Changed, at: &mut Moment<'_>) -> Result<u64, Failure>;

    /// Carries out a command or query that is neither a common one nor a setting.
    ///
    /// # Errors
    /// Fails with the entry for the error queue.
    fn perform(&mut self, unit: &Unit, at: &mut Moment<'_>) -> Result<Outcome, Failure>;

    /// Answers the query, or completes the command, that waited for the end of the job.
    ///
    /// # Errors
    /// Fails with the entry for the error queue.
    fn fetch(&mut self, unit: &Unit) -> Result<Outcome, Failure>;

    /// Returns the next instant at which the job acts; `None` without a job.
    fn next_us(&self) -> Option<u64>;

    /// Returns an instant before which the job does not end; `None` when the job does not know it.
    fn end_us(&self) -> Option<u64> {
        self.next_us()
    }

    /// Returns the next instant at which the instrument checks its own output; `None` while it does not.
    fn watch_us(&self) -> Option<u64> {
        None
    }

    /// Checks the output; returns an entry for the error queue when it has switched the output off.
    fn watch(&mut self, _: &mut Moment<'_>) -> Option<Failure> {
        None
    }

    /// Runs the due step of the job.
    fn tick(&mut self, at: &mut Moment<'_>);

    /// Runs the due step of the job, and may run further steps before `end_us`, because only the circuit acts until
    /// then. Leaves `at` at the last step that it ran.
    fn run(&mut self, at: &mut Moment<'_>, _end_us: u64) {
        self.tick(at);
    }

    /// Executes a command or query that is no common one.
    ///
    /// # Errors
    /// Fails with the entry for the error queue.
    fn execute(&mut self, unit: &Unit, at: &mut Moment<'_>) -> Result<Outcome, Failure> {
        let command_us = self.body().command_us;
        match self.body().settings.execute(unit)? {
            Some(Handled::Query(text)) => Ok(Outcome::Text(text, command_us)),
            Some(Handled::Change(changed)) => {
                let further_us = self.changed(changed, at)?;
                Ok(Outcome::Done(command_us + further_us))
            }
            None => self.perform(unit, at),
        }
    }
}

/// Model of an instrument.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Model {
    /// Source-measure unit.
    Smu,
    /// Multimeter.
    Multimeter,
    /// AC source.
    AcSource,
    /// Digitizer with the commands of Rigol.
    Rigol,
    /// Digitizer with the commands of Keysight.
    Keysight,
    /// Function generator that sends pulses.
    PulseSource,
}

read_words!(Model {
    "2450" => Self::Smu,
    "34461A" => Self::Multimeter,
    "61500" => Self::AcSource,
    "digitizer-rigol" => Self::Rigol,
    "digitizer-keysight" => Self::Keysight,
    "pulse-source" => Self::PulseSource,
});

impl Model {
    /// Number of channels of a digitizer.
    pub const CHANNELS: usize = digitizer::CHANNELS;

    /// Checks whether the model is a digitizer, of any dialect.
    pub fn is_digitizer(self) -> bool {
        matches!(self, Self::Rigol | Self::Keysight)
    }
}

/// Channel of a digitizer: the terminals that it sees, and the ratio of its probe or shunt.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Channel {
    /// Terminals that the probe touches.
    pub at: Terminal,
    /// Volts at the channel per volt at the terminals; at `load`, volts per ampere.
    pub ratio: f64,
}

read_fields!(Channel { at, ratio }, finish);

/// Settings of one instrument in the file.
#[derive(Debug, Clone)]
pub struct Fitting {
    /// Terminals to which the instrument connects.
    pub at: Option<Terminal>,
    /// Channels of a digitizer.
    pub channels: Vec<Channel>,
    /// Identity in place of the model's own.
    pub identity: Option<String>,
    /// Mean time to a reply in place of the model's own, microseconds.
    pub latency_us: Option<u64>,
    /// True for an instrument without errors.
    pub exact: bool,
}

/// Properties of a model besides its commands.
struct Kit {
    identity: &'static str,
    /// Mean time to a reply, microseconds.
    latency_us: u64,
    /// Execution time of a command, microseconds.
    command_us: u64,
    /// Terminals to which the instrument connects, unless the file names others.
    at: Terminal,
    settings: &'static [Setting],
}

/// Builds an instrument whose errors are drawn from `seed` and its name.
pub fn build(model: Model, name: &str, seed: u64, fitting: Fitting) -> Box<dyn Instrument> {
    let kit = match model {
        Model::Smu => smu::KIT,
        Model::Multimeter => multimeter::KIT,
        Model::AcSource => ac_source::KIT,
        Model::Rigol => digitizer::RIGOL,
        Model::Keysight => digitizer::KEYSIGHT,
        Model::PulseSource => pulse_source::KIT,
    };
    let channels = fitting.channels;
    let body = Body {
        identity: fitting.identity.unwrap_or_else(|| kit.identity.into()),
        at: fitting.at.unwrap_or(kit.at),
        settings: Settings::new(kit.settings),
        command_us: kit.command_us,
        latency_us: fitting.latency_us.unwrap_or(kit.latency_us),
        errors: Errors::draw(stream(seed, name), fitting.exact),
    };
    match model {
        Model::Smu => Box::new(smu::Smu::new(body)),
        Model::Multimeter => Box::new(multimeter::Multimeter::new(body)),
        Model::AcSource => Box::new(ac_source::AcSource::new(body)),
        Model::Rigol => Box::new(digitizer::Digitizer::new(body, &channels, Dialect::Rigol)),
        Model::Keysight => Box::new(digitizer::Digitizer::new(
            body,
            &channels,
            Dialect::Keysight,
        )),
        Model::PulseSource => Box::new(pulse_source::PulseSource::new(body)),
    }
}

/// Common part of every instrument.
pub struct Body {
    /// Reply to `*IDN?`.
    pub identity: String,
    at: Terminal,
    settings: Settings,
    command_us: u64,
    latency_us: u64,
    errors: Errors,
}

impl Body {
    /// Draws the time from the end of a query to its reply, microseconds: a mean with a scatter of 10 %.
    pub fn latency_us(&mut self) -> u64 {
        let scatter = 0.1 * self.errors.normal();
        (self.latency_us as f64 * (1.0 + scatter.clamp(-0.5, 1.0))) as u64
    }
}
