//! Instruments: commands, measurements and their errors.
//!
//! An instrument is a table of settings and a job that measures while time passes.

mod ac_source;
mod digitizer;
mod multimeter;
mod pulse_source;
mod settings;
mod smu;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use super::circuit::{Circuit, Reading, Terminal};
use super::message::Unit;
use super::status::Failure;
use crate::module::tolerances::stream;
use crate::table::{read_fields, read_words};

/// Result of a command or query.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// Done after so many microseconds, without reply.
    Done(u64),
    /// Reply, ready after so many microseconds.
    Text(String, u64),
    /// Reply of a block, ready after so many microseconds.
    Block(Vec<u8>, u64),
    /// The reply needs the end of the present job; [`Instrument::fetch`] gives it.
    AfterJob,
}

/// An instrument behind its command interpreter.
pub trait Instrument: Send {
    /// Returns identity, latency and errors.
    fn body(&mut self) -> &mut Body;

    /// Returns to the settings of `*RST`; returns the time that it takes, microseconds.
    fn reset(&mut self, now_us: u64) -> u64;

    /// Executes a command or query that is no common one.
    ///
    /// # Errors
    /// Fails with the entry for the error queue.
    fn execute(
        &mut self,
        unit: &Unit,
        now_us: u64,
        circuit: &mut dyn Circuit,
    ) -> Result<Outcome, Failure>;

    /// Answers a query that waited for the end of the job.
    ///
    /// # Errors
    /// Fails with the entry for the error queue.
    fn fetch(
        &mut self,
        unit: &Unit,
        now_us: u64,
        circuit: &mut dyn Circuit,
    ) -> Result<Outcome, Failure>;

    /// Returns the next instant at which the job acts; `None` without job.
    fn next_us(&self) -> Option<u64>;

    /// Returns an instant before which the job does not end.
    fn end_us(&self) -> Option<u64> {
        self.next_us()
    }

    /// Lets the job act.
    fn tick(&mut self, now_us: u64, circuit: &mut dyn Circuit);
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

/// Channel of a digitizer: what it sees, and the ratio of its probe or shunt.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Channel {
    /// Terminals that the probe touches.
    pub at: Terminal,
    /// Volts at the channel per volt at the terminals; at `load` per ampere.
    pub ratio: f64,
}

read_fields!(Channel { at, ratio }, finish);

/// Settings of one instrument in the file.
#[derive(Debug, Clone)]
pub struct Fitting {
    /// Terminals at which the instrument hangs.
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

/// Builds an instrument; `seed` and name draw its errors.
pub fn build(model: Model, name: &str, seed: u64, fitting: Fitting) -> Box<dyn Instrument> {
    let rng = stream(seed, name);
    let latency_us = fitting.latency_us.unwrap_or(match model {
        Model::Smu => 2_500,
        Model::Multimeter => 3_000,
        Model::AcSource => 15_000,
        Model::Rigol | Model::Keysight => 1_500,
        Model::PulseSource => 5_000,
    });
    let body = Body {
        identity: fitting.identity.unwrap_or_else(|| identity(model).into()),
        latency_us,
        errors: Errors::draw(rng, fitting.exact),
    };
    let terminal = |otherwise| fitting.at.unwrap_or(otherwise);
    match model {
        Model::Smu => Box::new(smu::Smu::new(body, terminal(Terminal::Input))),
        Model::Multimeter => Box::new(multimeter::Multimeter::new(
            body,
            terminal(Terminal::Output),
        )),
        Model::AcSource => Box::new(ac_source::AcSource::new(body, terminal(Terminal::Line))),
        Model::PulseSource => Box::new(pulse_source::PulseSource::new(
            body,
            terminal(Terminal::Pulse),
        )),
        Model::Rigol | Model::Keysight => {
            let dialect = match model {
                Model::Rigol => digitizer::Dialect::Rigol,
                _ => digitizer::Dialect::Keysight,
            };
            Box::new(digitizer::Digitizer::new(body, fitting.channels, dialect))
        }
    }
}

fn identity(model: Model) -> &'static str {
    match model {
        Model::Smu => "KEITHLEY INSTRUMENTS,MODEL 2450,04012345,1.7.12b",
        Model::Multimeter => {
            "Keysight Technologies,34461A,MY53201234,A.03.03-03.15-03.03-00.52-03-02"
        }
        Model::AcSource => "Chroma ATE,61503,61503A001234,1.50",
        Model::Rigol => "RIGOL TECHNOLOGIES,DHO804,DHO8A250100001,00.01.03",
        Model::Keysight => "KEYSIGHT TECHNOLOGIES,DSOX1204G,CN60120001,02.12",
        Model::PulseSource => "Agilent Technologies,33220A,MY44001234,2.07-2.06-22-2",
    }
}

/// What every instrument has.
pub struct Body {
    /// Reply to `*IDN?`.
    pub identity: String,
    latency_us: u64,
    errors: Errors,
}

impl Body {
    /// Draws the time from the end of a query to its reply: the mean with a scatter of 10 %, microseconds.
    pub fn latency_us(&mut self) -> u64 {
        let scatter = 0.1 * self.errors.normal();
        (self.latency_us as f64 * (1.0 + scatter.clamp(-0.5, 1.0))) as u64
    }
}

/// Limits of error of one function at one range.
#[derive(Debug, Clone, Copy)]
pub struct Accuracy {
    /// Part of the reading.
    pub gain: f64,
    /// Offset, in the unit of the reading.
    pub offset: f64,
    /// Standard deviation of the noise, in the unit of the reading.
    pub noise: f64,
}

/// Individual errors, as fractions of the maker's limits, and noise.
struct Errors {
    rng: ChaCha8Rng,
    gain: [f64; 4],
    offset: [f64; 4],
    exact: bool,
}

impl Errors {
    fn draw(mut rng: ChaCha8Rng, exact: bool) -> Self {
        let mut fractions = || std::array::from_fn(|_| 2.0 * rng.random::<f64>() - 1.0);
        let (gain, offset) = (fractions(), fractions());
        Self {
            rng,
            gain,
            offset,
            exact,
        }
    }

    fn normal(&mut self) -> f64 {
        if self.exact {
            0.0
        } else {
            self.rng.sample(StandardNormal)
        }
    }

    /// Adds the errors of a function (0 to 3) to a true value.
    fn apply(&mut self, function: usize, accuracy: Accuracy, value: f64) -> f64 {
        if self.exact {
            return value;
        }
        let gain = 1.0 + self.gain[function] * accuracy.gain;
        let noise = accuracy.noise * self.normal();
        value * gain + self.offset[function] * accuracy.offset + noise
    }
}

/// Means over a window, sample by sample.
#[derive(Debug, Clone, Copy, Default)]
struct Window {
    next_us: u64,
    step_us: u64,
    left: u32,
    count: u32,
    sum: Reading,
    squares: Reading,
    power: f64,
}

impl Window {
    /// Opens a window of `for_us` after a wait.
    fn open(from_us: u64, for_us: f64, samples: u32) -> Self {
        let step_us = (for_us / f64::from(samples)).ceil().max(1.0) as u64;
        Self {
            next_us: from_us + step_us,
            step_us,
            left: samples,
            ..Self::default()
        }
    }

    /// Takes a sample; true when it was the last one.
    fn take(&mut self, reading: Reading) -> bool {
        self.sum.volts += reading.volts;
        self.sum.amps += reading.amps;
        self.squares.volts += reading.volts * reading.volts;
        self.squares.amps += reading.amps * reading.amps;
        self.power += reading.volts * reading.amps;
        self.count += 1;
        self.left -= 1;
        self.next_us += self.step_us;
        self.left == 0
    }

    /// Returns the instant of the last sample.
    fn end_us(&self) -> u64 {
        self.next_us + u64::from(self.left.saturating_sub(1)) * self.step_us
    }

    fn mean(&self) -> Reading {
        let count = f64::from(self.count.max(1));
        Reading {
            volts: self.sum.volts / count,
            amps: self.sum.amps / count,
        }
    }

    fn rms(&self) -> Reading {
        let count = f64::from(self.count.max(1));
        Reading {
            volts: (self.squares.volts / count).sqrt(),
            amps: (self.squares.amps / count).sqrt(),
        }
    }
}
