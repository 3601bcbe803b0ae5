//! Source-measure unit of the 2450 class.

use std::collections::VecDeque;
use std::ops::ControlFlow;

use super::settings::{Kind, Setting, Settings};
use super::{Accuracy, Body, Instrument, Outcome, Window};
use crate::scpi::circuit::{Circuit, Drive, Reading, Terminal};
use crate::scpi::message::{Unit, nr3};
use crate::scpi::status::Failure;

/// Time of a command, microseconds.
const COMMAND_US: u64 = 400;
/// Settling of the output after a new level, microseconds.
const SETTLE_US: u64 = 200;
/// Resistance of the leads, which a two-wire measurement includes, ohms.
const LEADS_OHM: f64 = 0.15;
/// Reading beyond the range.
const OVER_RANGE: f64 = 9.9e37;

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
    Setting("format", ":FORMat[:DATA]", Choice(&["ASCii", "REAL"]), 1),
    Setting("beep", ":SYSTem:BEEPer", Ignored, 1),
    Setting("preset", ":STATus:PRESet", Ignored, 1),
    Setting("feed", ":TRACe:FEED", Ignored, 1),
    Setting("feed_control", ":TRACe:FEED:CONTrol", Ignored, 1),
    Setting("display", ":DISPlay:SCReen", Ignored, 1),
    Setting("measurement_events", ":STATus:MEASurement:ENABle", Ignored, 1),
];

/// Points of a measurement in work.
struct Job {
    levels: VecDeque<Option<f64>>,
    delay_us: u64,
    window: Window,
}

/// The unit with its settings, its job and its buffer.
pub(super) struct Smu {
    body: Body,
    at: Terminal,
    settings: Settings,
    job: Option<Job>,
    sweep: Option<(VecDeque<Option<f64>>, u64)>,
    /// Source level and reading of each point.
    buffer: Vec<(f64, f64)>,
}

impl Smu {
    pub(super) fn new(body: Body, at: Terminal) -> Self {
        let settings = Settings::new(TABLE);
        Self {
            body,
            at,
            settings,
            job: None,
            sweep: None,
            buffer: Vec::new(),
        }
    }

    fn sources_volts(&self) -> bool {
        self.settings.choice("source") == "VOLTage"
    }

    /// Returns the key of a setting of the present sense function.
    fn sense(&self, amps: &'static str, volts: &'static str, ohms: &'static str) -> f64 {
        self.settings.number(match self.settings.choice("sense") {
            "CURRent" => amps,
            "VOLTage" => volts,
            _ => ohms,
        })
    }

    /// Connects the source with its errors.
    fn drive(&mut self, circuit: &mut dyn Circuit) {
        let settings = &self.settings;
        let drive = if !settings.on("output") {
            Drive::Open
        } else if self.sources_volts() {
            let volts = settings.number("volts");
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
            let limit_a = settings.number("limit_a");
            Drive::Voltage {
                volts: self.body.errors.apply(0, accuracy, volts),
                limit_a,
            }
        } else {
            let amps = settings.number("amps");
            let range = range_of(settings, "amps", "amp_range", "amp_range_auto", &AMPS);
            let accuracy = Accuracy {
                gain: 3e-4,
                offset: 6e-4 * range,
                noise: 0.0,
            };
            let limit_v = settings.number("limit_v");
            Drive::Current {
                amps: self.body.errors.apply(1, accuracy, amps),
                limit_v,
            }
        };
        circuit.drive(self.at, drive);
    }

    fn start(&mut self, now_us: u64, levels: VecDeque<Option<f64>>, delay_us: u64) {
        let auto = self.sense("amp_sense_auto", "volt_sense_auto", "ohm_sense_auto") != 0.0;
        let delay_us = delay_us + if auto { 2_000 } else { 0 };
        let window = self.window(now_us + delay_us);
        self.job = Some(Job {
            levels,
            delay_us,
            window,
        });
    }

    fn window(&self, from_us: u64) -> Window {
        let cycles = self.sense("amp_plc", "volt_plc", "ohm_plc");
        let filter = self.sense("amp_filter", "volt_filter", "volt_filter") != 0.0;
        let filter_count = self.sense("amp_filter_count", "volt_filter_count", "volt_filter_count");
        let count = if filter { filter_count } else { 1.0 };
        Window::open(from_us, cycles * count * 20_000.0, 8)
    }

    /// Turns the mean of a window into a reading with its errors.
    fn reading(&mut self, mean: Reading) -> f64 {
        let wires = self.sense("amp_wires", "volt_wires", "ohm_wires") != 0.0;
        let cycles = self.sense("amp_plc", "volt_plc", "ohm_plc");
        let quiet = 1.0 / cycles.sqrt().max(0.1);
        let volts = mean.volts + if wires { 0.0 } else { mean.amps * LEADS_OHM };
        let auto = self.sense("amp_sense_auto", "volt_sense_auto", "ohm_sense_auto") != 0.0;
        let set = self.sense("amp_sense", "volt_sense", "ohm_sense");
        let select = |true_value: f64, steps: &[f64]| match auto {
            true => step_for(true_value, steps),
            false => step_for(set, steps),
        };
        match self.settings.choice("sense") {
            "CURRent" => {
                let range = select(mean.amps, &AMPS);
                let (gain, offset) = current_accuracy(range);
                let accuracy = Accuracy {
                    gain,
                    offset,
                    noise: 0.05 * offset * quiet,
                };
                within(self.body.errors.apply(2, accuracy, mean.amps), range)
            }
            "VOLTage" => {
                let range = select(volts, &VOLTS);
                let offset = (5e-5 * range).max(2e-4);
                let accuracy = Accuracy {
                    gain: 1.5e-4,
                    offset,
                    noise: 0.02 * offset * quiet,
                };
                within(self.body.errors.apply(3, accuracy, volts), range)
            }
            _ if mean.amps == 0.0 => OVER_RANGE,
            _ => {
                let ohms = volts / mean.amps;
                let accuracy = Accuracy {
                    gain: 5e-4,
                    offset: 1e-3,
                    noise: 1e-5 * ohms.abs(),
                };
                within(
                    self.body.errors.apply(3, accuracy, ohms),
                    if auto { 2e8 } else { set },
                )
            }
        }
    }

    /// Reads the parameters of a linear sweep: start, stop, points or step, delay.
    fn sweep(&mut self, unit: &Unit, by_step: bool) -> Result<Outcome, Failure> {
        let at = |number| unit.number(number, -1e6, 1e6, 0.0);
        let (from, to, third) = (at(0)?, at(1)?, at(2)?);
        let delay_s = if unit.parameters.len() > 3 {
            at(3)?
        } else {
            0.0
        };
        let points = match by_step {
            true if third == 0.0 => return Err(Failure::OUT_OF_RANGE),
            true => ((to - from) / third).abs().round() + 1.0,
            false => third,
        };
        if !(2.0..=1e6).contains(&points) {
            return Err(Failure::OUT_OF_RANGE);
        }
        let level = |n: u64| Some(from + (to - from) * n as f64 / (points - 1.0));
        let levels = (0..points as u64).map(level).collect();
        self.sweep = Some((levels, (delay_s.max(0.0) * 1e6) as u64));
        Ok(Outcome::Done(COMMAND_US * 3))
    }

    fn data(&self, unit: &Unit) -> Result<Outcome, Failure> {
        let many = self.buffer.len();
        let (from, to) = match unit.parameters.len() {
            0 => (1, many),
            _ => (
                unit.number(0, 1.0, 1e6, 1.0)? as usize,
                unit.number(1, 1.0, 1e6, 1.0)? as usize,
            ),
        };
        let points = self.buffer.get(from - 1..to).ok_or(Failure::OUT_OF_RANGE)?;
        let mut columns: Vec<bool> = Vec::new();
        for number in 3..unit.parameters.len() {
            columns.push(match unit.word(number)?.as_str() {
                "SOUR" | "SOURCE" => true,
                "READ" | "READING" => false,
                _ => return Err(Failure::ILLEGAL_VALUE),
            });
        }
        if columns.is_empty() {
            columns.push(false);
        }
        let row = |(source, read): &(f64, f64)| {
            let cell = |is_source: &bool| nr3(if *is_source { *source } else { *read });
            columns.iter().map(cell).collect::<Vec<_>>().join(",")
        };
        let text = points.iter().map(row).collect::<Vec<_>>().join(",");
        Ok(Outcome::Text(text, 20 * points.len() as u64))
    }

    fn statistics(&self, unit: &Unit) -> Option<f64> {
        let has = |pattern| unit.matches(pattern).is_some();
        let count = self.buffer.len() as f64;
        let reads = || self.buffer.iter().map(|(_, read)| *read);
        let mean = reads().sum::<f64>() / count;
        if has(":TRACe:STATistics:AVERage") {
            Some(mean)
        } else if has(":TRACe:STATistics:MAXimum") {
            Some(reads().fold(f64::MIN, f64::max))
        } else if has(":TRACe:STATistics:MINimum") {
            Some(reads().fold(f64::MAX, f64::min))
        } else if has(":TRACe:STATistics:STDDev") {
            let squares: f64 = reads().map(|read| (read - mean).powi(2)).sum();
            Some((squares / (count - 1.0).max(1.0)).sqrt())
        } else {
            None
        }
    }
}

impl Instrument for Smu {
    fn body(&mut self) -> &mut Body {
        &mut self.body
    }

    fn reset(&mut self, now_us: u64) -> u64 {
        self.settings.reset();
        self.buffer.clear();
        self.sweep = None;
        // A job without points and samples only disconnects the source.
        self.job = Some(Job {
            levels: VecDeque::new(),
            delay_us: 0,
            window: Window {
                next_us: now_us,
                ..Window::default()
            },
        });
        20_000
    }

    fn execute(
        &mut self,
        unit: &Unit,
        now_us: u64,
        circuit: &mut dyn Circuit,
    ) -> Result<Outcome, Failure> {
        if let ControlFlow::Break(done) = self.settings.execute(unit)? {
            let (key, _) = match done {
                Ok(text) => return Ok(Outcome::Text(text, COMMAND_US)),
                Err(changed) => changed,
            };
            match key {
                "volt_range" | "amp_range" | "amp_sense" | "volt_sense" | "ohm_sense" => {
                    let auto = TABLE
                        .iter()
                        .find(|it| it.0.strip_suffix("_auto") == Some(key));
                    auto.into_iter().for_each(|it| self.settings.set(it.0, 0.0));
                }
                "source" | "volts" | "amps" | "limit_a" | "limit_v" | "output" => {
                    self.drive(circuit);
                    return Ok(Outcome::Done(COMMAND_US + SETTLE_US));
                }
                _ => {}
            }
            return Ok(Outcome::Done(COMMAND_US));
        }
        let has = |pattern| unit.matches(pattern).is_some();
        match unit.query {
            true if has(":READ") || has(":MEASure[:CURRent]") => {
                if self.job.is_some() {
                    return Err(Failure::INIT_IGNORED);
                }
                self.buffer.clear();
                self.start(now_us, [None].into(), 0);
                Ok(Outcome::AfterJob)
            }
            true if has(":FETCh") => self.fetch(unit, now_us, circuit),
            true if has("*LANG") => Ok(Outcome::Text("SCPI".into(), COMMAND_US)),
            true if has(":TRACe:DATA") => Ok(Outcome::AfterJob),
            true if has(":TRACe:ACTual") => {
                Ok(Outcome::Text(self.buffer.len().to_string(), COMMAND_US))
            }
            true => match self.statistics(unit) {
                Some(_) if self.buffer.is_empty() => Err(Failure::DATA_STALE),
                Some(value) => Ok(Outcome::Text(nr3(value), COMMAND_US)),
                None => Err(Failure::UNDEFINED_HEADER),
            },
            false if has("[:SOURce#]:SWEep:VOLTage:LINear:STEP") => self.sweep(unit, true),
            false if has("[:SOURce#]:SWEep:VOLTage:LINear") => self.sweep(unit, false),
            false if has("[:SOURce#]:SWEep:CURRent:LINear:STEP") => self.sweep(unit, true),
            false if has("[:SOURce#]:SWEep:CURRent:LINear") => self.sweep(unit, false),
            false if has(":INITiate[:IMMediate]") || has("*TRG") => {
                if self.job.is_some() {
                    return Err(Failure::INIT_IGNORED);
                }
                self.buffer.clear();
                let one = || (VecDeque::from([None]), 0);
                let (levels, delay_us) = self.sweep.clone().unwrap_or_else(one);
                self.start(now_us, levels, delay_us);
                self.next_level(circuit);
                Ok(Outcome::Done(COMMAND_US))
            }
            false if has(":ABORt") => {
                self.job = None;
                Ok(Outcome::Done(COMMAND_US))
            }
            false if has(":TRACe:CLEar") => {
                self.buffer.clear();
                Ok(Outcome::Done(COMMAND_US))
            }
            false => Err(Failure::UNDEFINED_HEADER),
        }
    }

    fn fetch(&mut self, unit: &Unit, _: u64, _: &mut dyn Circuit) -> Result<Outcome, Failure> {
        if unit.matches(":TRACe:DATA").is_some() {
            return self.data(unit);
        }
        let (_, read) = self.buffer.last().ok_or(Failure::DATA_STALE)?;
        Ok(Outcome::Text(nr3(*read), 0))
    }

    fn next_us(&self) -> Option<u64> {
        self.job.as_ref().map(|job| job.window.next_us)
    }

    fn end_us(&self) -> Option<u64> {
        let job = self.job.as_ref()?;
        let later = job.levels.len().saturating_sub(1) as u64;
        Some(job.window.end_us() + later * (job.delay_us + 8 * job.window.step_us))
    }

    fn tick(&mut self, now_us: u64, circuit: &mut dyn Circuit) {
        let Some(job) = &mut self.job else {
            return;
        };
        if job.levels.is_empty() {
            self.job = None;
            self.drive(circuit);
            return;
        }
        if !job.window.take(circuit.at(self.at)) {
            return;
        }
        let (mean, delay_us) = (job.window.mean(), job.delay_us);
        job.levels.pop_front();
        let ended = job.levels.is_empty();
        let level = self.settings.number(if self.sources_volts() {
            "volts"
        } else {
            "amps"
        });
        let read = self.reading(mean);
        self.buffer.push((level, read));
        if ended {
            self.job = None;
            return;
        }
        self.next_level(circuit);
        let window = self.window(now_us + delay_us);
        if let Some(job) = &mut self.job {
            job.window = window;
        }
    }
}

impl Smu {
    /// Sets the level of the next point.
    fn next_level(&mut self, circuit: &mut dyn Circuit) {
        let level = self.job.as_ref().and_then(|job| *job.levels.front()?);
        if let Some(level) = level {
            let key = if self.sources_volts() {
                "volts"
            } else {
                "amps"
            };
            self.settings.set(key, level);
            self.drive(circuit);
        }
    }
}

/// Ranges of voltage and current.
const VOLTS: [f64; 5] = [0.02, 0.2, 2.0, 20.0, 200.0];
const AMPS: [f64; 9] = [1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0];

/// Returns the smallest range that holds a value.
fn step_for(value: f64, steps: &[f64]) -> f64 {
    let fits = steps.iter().find(|step| value.abs() <= **step * 1.05);
    *fits.unwrap_or(&steps[steps.len() - 1])
}

fn range_of(settings: &Settings, level: &str, range: &str, auto: &str, steps: &[f64]) -> f64 {
    let of = if settings.on(auto) { level } else { range };
    step_for(settings.number(of), steps)
}

fn within(value: f64, range: f64) -> f64 {
    if value.abs() > 1.055 * range {
        OVER_RANGE.copysign(value)
    } else {
        value
    }
}

/// Returns gain and offset of the current measurement, one year.
fn current_accuracy(range: f64) -> (f64, f64) {
    match range {
        ..=1e-8 => (1e-3, 5e-11),
        ..=1e-7 => (6e-4, 1e-10),
        ..=1e-6 => (2.5e-4, 3e-10),
        ..=1e-5 => (2.5e-4, 7e-10),
        ..=1e-4 => (2e-4, 6e-9),
        ..=1e-3 => (2e-4, 6e-8),
        ..=1e-2 => (2e-4, 6e-7),
        ..=1e-1 => (2.5e-4, 6e-6),
        _ => (3e-4, 5e-4),
    }
}
