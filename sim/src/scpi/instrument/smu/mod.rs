//! Source-measure unit of the 2450 class.

mod buffer;
mod sweep;

use std::collections::VecDeque;

use super::errors::Accuracy;
use super::settings::{Changed, Kind, Setting, Settings};
use super::window::Window;
use super::{Body, Instrument, Kit, Moment, Outcome};
use crate::scpi::circuit::{Circuit, Drive, Reading, Terminal};
use crate::scpi::message::{Unit, nr3};
use crate::scpi::status::Failure;
use buffer::Buffer;
use sweep::Sweep;

/// Settling of the output after a new level, microseconds.
const SETTLE_US: u64 = 200;
/// Time to choose a range automatically, microseconds.
const RANGING_US: u64 = 2_000;
/// Resistance of the leads in a two-wire connection, ohms.
const LEADS_OHM: f64 = 0.15;

pub(super) const KIT: Kit = Kit {
    identity: "KEITHLEY INSTRUMENTS,MODEL 2450,04012345,1.7.12b",
    latency_us: 2_500,
    command_us: 400,
    at: Terminal::Input,
    settings: TABLE,
};

use Kind::{Choice, Ignored, Number, Switch};
#[rustfmt::skip]
const TABLE: &[Setting] = &[
    Setting("source", "[:SOURce#]:FUNCtion[:MODE]", Choice(&["VOLTage", "CURRent"]), 1),
    Setting("volts", "[:SOURce#]:VOLTage[:LEVel][:IMMediate][:AMPLitude]", Number(-210.0, 210.0, 0.0), 1),
    Setting("amps", "[:SOURce#]:CURRent[:LEVel][:IMMediate][:AMPLitude]", Number(-1.05, 1.05, 0.0), 1),
    Setting("volt_range", "[:SOURce#]:VOLTage:RANGe", Number(0.02, 210.0, 0.02), 1),
    Setting("amp_range", "[:SOURce#]:CURRent:RANGe", Number(1e-8, 1.05, 1e-8), 1),
    Setting("volt_range_auto", "[:SOURce#]:VOLTage:RANGe:AUTO", Switch(true), 1),
    Setting("amp_range_auto", "[:SOURce#]:CURRent:RANGe:AUTO", Switch(true), 1),
    Setting("limit_a", "[:SOURce#]:VOLTage:ILIMit[:LEVel]", Number(1e-9, 1.05, 1.05e-4), 1),
    Setting("limit_v", "[:SOURce#]:CURRent:VLIMit[:LEVel]", Number(0.02, 210.0, 21.0), 1),
    Setting("volt_delay_s", "[:SOURce#]:VOLTage:DELay", Number(0.0, 1e4, 0.0), 1),
    Setting("amp_delay_s", "[:SOURce#]:CURRent:DELay", Number(0.0, 1e4, 0.0), 1),
    Setting("volt_delay_auto", "[:SOURce#]:VOLTage:DELay:AUTO", Switch(true), 1),
    Setting("amp_delay_auto", "[:SOURce#]:CURRent:DELay:AUTO", Switch(true), 1),
    Setting("sense", "[:SENSe#]:FUNCtion[:ON]", Choice(&["CURRent", "VOLTage", "RESistance"]), 1),
    Setting("amp_sense", "[:SENSe#]:CURRent[:DC]:RANGe[:UPPer]", Number(1e-8, 1.05, 1e-4), 1),
    Setting("volt_sense", "[:SENSe#]:VOLTage[:DC]:RANGe[:UPPer]", Number(0.02, 210.0, 2.0), 1),
    Setting("ohm_sense", "[:SENSe#]:RESistance:RANGe[:UPPer]", Number(2.0, 210e6, 210e6), 1),
    Setting("amp_sense_auto", "[:SENSe#]:CURRent[:DC]:RANGe:AUTO", Switch(true), 1),
    Setting("volt_sense_auto", "[:SENSe#]:VOLTage[:DC]:RANGe:AUTO", Switch(true), 1),
    Setting("ohm_sense_auto", "[:SENSe#]:RESistance:RANGe:AUTO", Switch(true), 1),
    Setting("amp_plc", "[:SENSe#]:CURRent[:DC]:NPLCycles", Number(0.01, 10.0, 1.0), 1),
    Setting("volt_plc", "[:SENSe#]:VOLTage[:DC]:NPLCycles", Number(0.01, 10.0, 1.0), 1),
    Setting("ohm_plc", "[:SENSe#]:RESistance:NPLCycles", Number(0.01, 10.0, 1.0), 1),
    Setting("amp_wires", "[:SENSe#]:CURRent[:DC]:RSENse", Switch(false), 1),
    Setting("volt_wires", "[:SENSe#]:VOLTage[:DC]:RSENse", Switch(false), 1),
    Setting("ohm_wires", "[:SENSe#]:RESistance:RSENse", Switch(false), 1),
    Setting("amp_filter", "[:SENSe#]:CURRent[:DC]:AVERage[:STATe]", Switch(false), 1),
    Setting("volt_filter", "[:SENSe#]:VOLTage[:DC]:AVERage[:STATe]", Switch(false), 1),
    Setting("amp_filter_count", "[:SENSe#]:CURRent[:DC]:AVERage:COUNt", Number(1.0, 100.0, 10.0), 1),
    Setting("volt_filter_count", "[:SENSe#]:VOLTage[:DC]:AVERage:COUNt", Number(1.0, 100.0, 10.0), 1),
    Setting("amp_filter_kind", "[:SENSe#]:CURRent[:DC]:AVERage:TCONtrol", Choice(&["REPeat", "MOVing"]), 1),
    Setting("volt_filter_kind", "[:SENSe#]:VOLTage[:DC]:AVERage:TCONtrol", Choice(&["REPeat", "MOVing"]), 1),
    Setting("count", "[:SENSe#]:COUNt", Number(1.0, 300_000.0, 1.0), 1),
    Setting("output", ":OUTPut#[:STATe]", Switch(false), 1),
    Setting("volt_off", ":OUTPut#:VOLTage:SMODe", Choice(&["NORMal", "HIMPedance", "ZERO", "GUARd"]), 1),
    Setting("amp_off", ":OUTPut#:CURRent:SMODe", Choice(&["NORMal", "HIMPedance", "ZERO", "GUARd"]), 1),
    Setting("terminals", ":ROUTe:TERMinals", Choice(&["FRONt", "REAR"]), 1),
    Setting("points", ":TRACe:POINts", Number(10.0, 1e6, 100_000.0), 1),
    Setting("format", ":FORMat[:DATA]", Choice(&["ASCii"]), 1),
    Setting("beep", ":SYSTem:BEEPer", Ignored, 1),
    Setting("preset", ":STATus:PRESet", Ignored, 1),
    Setting("feed", ":TRACe:FEED", Ignored, 1),
    Setting("feed_control", ":TRACe:FEED:CONTrol", Ignored, 1),
    Setting("display", ":DISPlay:SCReen", Ignored, 1),
    Setting("measurement_events", ":STATus:MEASurement:ENABle", Ignored, 1),
];

/// A measurement in progress: the source levels of its remaining points, `None` where the source stays as it is.
struct Job {
    levels: VecDeque<Option<f64>>,
    delay_us: u64,
    window: Window,
}

/// The unit with its settings, its job and its buffer.
pub(super) struct Smu {
    body: Body,
    job: Option<Job>,
    sweep: Option<Sweep>,
    buffer: Buffer,
}

impl Smu {
    pub(super) fn new(body: Body) -> Self {
        Self {
            body,
            job: None,
            sweep: None,
            buffer: Buffer::default(),
        }
    }

    /// Returns the key of the setting that holds the source level.
    fn level_key(&self) -> &'static str {
        match self.body.settings.choice("source") {
            "VOLTage" => "volts",
            _ => "amps",
        }
    }

    /// Returns the value of a setting that each sense function has on its own, for the present function.
    fn sense(&self, amps: &'static str, volts: &'static str, ohms: &'static str) -> f64 {
        let settings = &self.body.settings;
        settings.number(match settings.choice("sense") {
            "CURRent" => amps,
            "VOLTage" => volts,
            _ => ohms,
        })
    }

    /// Returns the lead resistance that the measurement includes, ohms: 0 with remote sensing.
    fn leads_ohm(&self) -> f64 {
        match self.sense("amp_wires", "volt_wires", "ohm_wires") {
            0.0 => LEADS_OHM,
            _ => 0.0,
        }
    }

    /// Checks whether range and limit of the source stay within its power: 105 mA above the 20 V range, 21 V above the
    /// 100 mA range.
    fn is_within_power(&self) -> bool {
        let settings = &self.body.settings;
        match settings.choice("source") {
            "VOLTage" => {
                let range = range_of(settings, "volts", "volt_range", "volt_range_auto", &VOLTS);
                range <= 20.0 || settings.number("limit_a") <= 0.105
            }
            _ => {
                let range = range_of(settings, "amps", "amp_range", "amp_range_auto", &AMPS);
                range <= 0.1 || settings.number("limit_v") <= 21.0
            }
        }
    }

    fn ranges_itself(&self) -> bool {
        self.sense("amp_sense_auto", "volt_sense_auto", "ohm_sense_auto") != 0.0
    }

    /// Connects the source, its errors included.
    fn drive(&mut self, circuit: &mut dyn Circuit) {
        let source_ohm = self.leads_ohm();
        let Body {
            settings, errors, ..
        } = &mut self.body;
        let drive = if !settings.on("output") {
            Drive::Open
        } else if settings.choice("source") == "VOLTage" {
            let range = range_of(settings, "volts", "volt_range", "volt_range_auto", &VOLTS);
            let offset = match range {
                ..=0.2 => 2e-4,
                ..=2.0 => 3e-4,
                ..=20.0 => 2.4e-3,
                _ => 2.4e-2,
            };
            let accuracy = Accuracy {
                gain: 1.5e-4,
                offset,
                noise: 0.0,
            };
            Drive::Voltage {
                volts: errors.apply(0, accuracy, settings.number("volts")),
                limit_a: settings.number("limit_a"),
                source_ohm,
            }
        } else {
            let range = range_of(settings, "amps", "amp_range", "amp_range_auto", &AMPS);
            let accuracy = Accuracy {
                gain: 6.7e-4,
                offset: 9e-4 * range,
                noise: 0.0,
            };
            Drive::Current {
                amps: errors.apply(1, accuracy, settings.number("amps")),
                limit_v: settings.number("limit_v"),
            }
        };
        circuit.drive(self.body.at, drive);
    }

    /// Starts to measure the given points.
    ///
    /// # Errors
    /// Fails while another measurement is in progress.
    fn start(
        &mut self,
        now_us: u64,
        levels: VecDeque<Option<f64>>,
        delay_us: u64,
    ) -> Result<(), Failure> {
        if self.job.is_some() {
            return Err(Failure::INIT_IGNORED);
        }
        self.buffer.clear();
        let ranging_us = if self.ranges_itself() { RANGING_US } else { 0 };
        let delay_us = delay_us + ranging_us;
        let window = self.window(now_us + delay_us);
        self.job = Some(Job {
            levels,
            delay_us,
            window,
        });
        Ok(())
    }

    /// Returns the points of a measurement without a sweep: the present level, repeated as often as the setting `count`
    /// says.
    fn present_level(&self) -> VecDeque<Option<f64>> {
        vec![None; self.body.settings.number("count") as usize].into()
    }

    fn window(&self, from_us: u64) -> Window {
        let cycles = self.sense("amp_plc", "volt_plc", "ohm_plc");
        let filter = self.sense("amp_filter", "volt_filter", "volt_filter") != 0.0;
        let filter_count = self.sense("amp_filter_count", "volt_filter_count", "volt_filter_count");
        let count = if filter { filter_count } else { 1.0 };
        Window::open(from_us, cycles * count * 20_000.0, 8)
    }

    /// Returns the reading for the mean of a window, errors included.
    fn reading(&mut self, mean: Reading) -> f64 {
        let cycles = self.sense("amp_plc", "volt_plc", "ohm_plc");
        let quiet = 1.0 / cycles.sqrt().max(0.1);
        let volts = mean.volts + mean.amps * self.leads_ohm();
        let auto = self.ranges_itself();
        let set = self.sense("amp_sense", "volt_sense", "ohm_sense");
        let select = |value: f64, steps: &[f64]| step_for(if auto { value } else { set }, steps);
        let errors = &mut self.body.errors;
        match self.body.settings.choice("sense") {
            "CURRent" => {
                let range = select(mean.amps, &AMPS);
                let (gain, offset, noise) = current_accuracy(range);
                let accuracy = Accuracy {
                    gain,
                    offset,
                    noise: noise * quiet,
                };
                within(errors.apply(2, accuracy, mean.amps), range)
            }
            "VOLTage" => {
                let range = select(volts, &VOLTS);
                let (offset, noise) = match range {
                    ..=0.2 => (2e-4, 5e-6),
                    ..=2.0 => (3e-4, 1e-5),
                    _ => (5e-5 * range, 2.5e-6 * range),
                };
                let accuracy = Accuracy {
                    gain: 1.5e-4,
                    offset,
                    noise: noise * quiet,
                };
                within(errors.apply(3, accuracy, volts), range)
            }
            _ if mean.amps == 0.0 => f64::INFINITY,
            _ => {
                let ohms = volts / mean.amps;
                let accuracy = Accuracy {
                    gain: 5e-4,
                    offset: 1e-3,
                    noise: 1e-5 * ohms.abs(),
                };
                let range = if auto { 2e8 } else { set };
                within(errors.apply(3, accuracy, ohms), range)
            }
        }
    }

    /// Starts the configured sweep, or without one a measurement at the present level.
    fn initiate(&mut self, now_us: u64, circuit: &mut dyn Circuit) -> Result<(), Failure> {
        let (levels, delay_us) = match self.sweep.clone() {
            Some(sweep) if sweep.key != self.level_key() => return Err(Failure::SETTINGS_CONFLICT),
            Some(sweep) => (sweep.levels, sweep.delay_us),
            None => (self.present_level(), 0),
        };
        self.start(now_us, levels, delay_us)?;
        self.next_level(circuit);
        Ok(())
    }

    /// Sets the source to the level of the next point.
    fn next_level(&mut self, circuit: &mut dyn Circuit) {
        let level = self.job.as_ref().and_then(|job| *job.levels.front()?);
        if let Some(level) = level {
            self.body.settings.set(self.level_key(), level);
            self.drive(circuit);
        }
    }
}

impl Instrument for Smu {
    fn body(&mut self) -> &mut Body {
        &mut self.body
    }

    fn reset(&mut self, at: &mut Moment<'_>) -> u64 {
        self.body.settings.reset();
        self.buffer.clear();
        (self.job, self.sweep) = (None, None);
        self.drive(at.circuit);
        20_000
    }

    fn changed(&mut self, changed: Changed, at: &mut Moment<'_>) -> Result<u64, Failure> {
        if !self.is_within_power() {
            self.body.settings.set(changed.key, changed.before);
            return Err(Failure::SETTINGS_CONFLICT);
        }
        match changed.key {
            key @ ("volt_range" | "amp_range" | "amp_sense" | "volt_sense" | "ohm_sense") => {
                let is_auto = |it: &&Setting| it.0.strip_suffix("_auto") == Some(key);
                let auto = TABLE.iter().find(is_auto);
                auto.into_iter()
                    .for_each(|it| self.body.settings.set(it.0, 0.0));
            }
            "source" | "volts" | "amps" | "limit_a" | "limit_v" | "output" => {
                self.drive(at.circuit);
                return Ok(SETTLE_US);
            }
            "sense" | "amp_wires" | "volt_wires" | "ohm_wires" => self.drive(at.circuit),
            _ => {}
        }
        Ok(0)
    }

    fn perform(&mut self, unit: &Unit, at: &mut Moment<'_>) -> Result<Outcome, Failure> {
        let has = |pattern| unit.matches(pattern).is_some();
        let command_us = self.body.command_us;
        let text = |text: String| Ok(Outcome::Text(text, command_us));
        match unit.query {
            true if has(":READ") || measured(unit).is_some() => {
                if let Some(function) = measured(unit) {
                    self.body.settings.set("sense", function);
                    self.drive(at.circuit);
                }
                self.start(at.now_us, self.present_level(), 0)?;
                return Ok(Outcome::AfterJob);
            }
            true if has(":FETCh") => return self.fetch(unit),
            true if has("*LANG") => return text("SCPI".into()),
            true if has(":TRACe:DATA") => return Ok(Outcome::AfterJob),
            true if has(":TRACe:ACTual") => return text(self.buffer.count().to_string()),
            true => return text(nr3(self.buffer.statistic(unit)?)),
            false if Sweep::is_in(unit) => self.sweep = Some(Sweep::read(unit)?),
            false if has(":INITiate[:IMMediate]") || has("*TRG") => {
                self.initiate(at.now_us, at.circuit)?;
            }
            false if has(":ABORt") => self.job = None,
            false if has(":TRACe:CLEar") => self.buffer.clear(),
            false => return Err(Failure::UNDEFINED_HEADER),
        }
        Ok(Outcome::Done(command_us))
    }

    fn fetch(&mut self, unit: &Unit) -> Result<Outcome, Failure> {
        if unit.matches(":TRACe:DATA").is_some() {
            return self.buffer.data(unit);
        }
        Ok(Outcome::Text(nr3(self.buffer.last()?), 0))
    }

    fn next_us(&self) -> Option<u64> {
        self.job.as_ref().map(|job| job.window.next_us())
    }

    fn end_us(&self) -> Option<u64> {
        let job = self.job.as_ref()?;
        let later = job.levels.len().saturating_sub(1) as u64;
        Some(job.window.end_us() + later * (job.delay_us + job.window.for_us()))
    }

    fn tick(&mut self, at: &mut Moment<'_>) {
        let Some(job) = &mut self.job else {
            return;
        };
        if !job.window.take(at.circuit.at(self.body.at)) {
            return;
        }
        let (mean, delay_us) = (job.window.mean(), job.delay_us);
        job.levels.pop_front();
        let ended = job.levels.is_empty();
        let level = self.body.settings.number(self.level_key());
        let read = self.reading(mean);
        self.buffer.push(level, read);
        if ended {
            self.job = None;
            return;
        }
        self.next_level(at.circuit);
        let window = self.window(at.now_us + delay_us);
        if let Some(job) = &mut self.job {
            job.window = window;
        }
    }
}

/// Returns the sense function of a `MEASure?` query as the index of its choice.
fn measured(unit: &Unit) -> Option<f64> {
    let is = |pattern: &str| unit.matches(pattern).is_some();
    let all = ["[:CURRent][:DC]", ":VOLTage[:DC]", ":RESistance"];
    let found = all.iter().position(|it| is(&format!(":MEASure{it}")));
    found.map(|index| index as f64)
}

/// Ranges of voltage and current.
const VOLTS: [f64; 5] = [0.02, 0.2, 2.0, 20.0, 200.0];
const AMPS: [f64; 9] = [1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0];

/// Returns the smallest range that holds the value.
fn step_for(value: f64, steps: &[f64]) -> f64 {
    let fits = steps.iter().find(|step| value.abs() <= **step * 1.05);
    *fits.unwrap_or(&steps[steps.len() - 1])
}

fn range_of(settings: &Settings, level: &str, range: &str, auto: &str, steps: &[f64]) -> f64 {
    let of = if settings.on(auto) { level } else { range };
    step_for(settings.number(of), steps)
}

/// Returns the value, or infinity when it exceeds the range.
fn within(value: f64, range: f64) -> f64 {
    if value.abs() > 1.055 * range {
        f64::INFINITY.copysign(value)
    } else {
        value
    }
}

/// Returns one-year limits of gain and offset of the current measurement, and its noise at one period.
fn current_accuracy(range: f64) -> (f64, f64, f64) {
    match range {
        ..=1e-8 => (1e-3, 5e-11, 4e-12),
        ..=1e-7 => (6e-4, 1e-10, 8e-12),
        ..=1e-6 => (2.5e-4, 3e-10, 2e-11),
        ..=1e-5 => (2.5e-4, 7e-10, 5e-11),
        ..=1e-4 => (2e-4, 6e-9, 5e-10),
        ..=1e-3 => (2e-4, 6e-8, 5e-9),
        ..=1e-2 => (2e-4, 6e-7, 5e-8),
        ..=1e-1 => (2.5e-4, 6e-6, 5e-7),
        _ => (3e-4, 5e-4, 3e-5),
    }
}
