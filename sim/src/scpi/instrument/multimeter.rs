//! Multimeter of the 34461A class.

use super::errors::Accuracy;
use super::settings::{Changed, Kind, Setting};
use super::window::Window;
use super::{Body, Instrument, Kit, Moment, Outcome};
use crate::scpi::circuit::{Circuit, Drive, Terminal};
use crate::scpi::message::{Unit, nr3};
use crate::scpi::status::Failure;

/// Time to change the function, and (the next constant) to choose a range automatically, microseconds.
const CONFIGURE_US: u64 = 40_000;
const RANGING_US: u64 = 10_000;
/// Time from the trigger to the start of the measuring window, microseconds.
const TRIGGER_US: u64 = 300;
/// Measuring window of an AC measurement, microseconds: ten cycles of 50 Hz.
const AC_US: f64 = 200_000.0;
/// Source of a resistance measurement.
const OHMS_SOURCE: Drive = Drive::Current {
    amps: 1e-3,
    limit_v: 12.0,
};
/// Resistance of the leads, which a two-wire measurement includes, ohms.
const LEADS_OHM: f64 = 0.2;

pub(super) const KIT: Kit = Kit {
    identity: "Keysight Technologies,34461A,MY53201234,A.03.03-03.15-03.03-00.52-03-02",
    latency_us: 3_000,
    command_us: 500,
    at: Terminal::Output,
    settings: TABLE,
};

/// Functions: header after CONFigure or MEASure, choice of the setting, ranges, index of the errors.
const FUNCTIONS: [(&str, &str, &[f64], usize); 6] = [
    ("VOLTage:DC", "VOLT", &[0.1, 1.0, 10.0, 100.0, 1000.0], 0),
    ("VOLTage:AC", "VOLT:AC", &[0.1, 1.0, 10.0, 100.0, 750.0], 1),
    ("CURRent:DC", "CURR", &AMPS, 2),
    ("CURRent:AC", "CURR:AC", &AMPS, 2),
    ("RESistance", "RES", &OHMS, 3),
    ("FRESistance", "FRES", &OHMS, 3),
];
const AMPS: [f64; 7] = [1e-4, 1e-3, 1e-2, 0.1, 1.0, 3.0, 10.0];
const OHMS: [f64; 7] = [100.0, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8];

use Kind::{Choice, Ignored, Number, Switch};
#[rustfmt::skip]
const TABLE: &[Setting] = &[
    Setting("count", ":SAMPle:COUNt", Number(1.0, 10_000.0, 1.0), 1),
    Setting("trigger", ":TRIGger:SOURce", Choice(&["IMMediate", "BUS", "EXTernal"]), 1),
    Setting("trigger_delay_s", ":TRIGger:DELay", Number(0.0, 3600.0, 0.0), 1),
    Setting("trigger_delay_auto", ":TRIGger:DELay:AUTO", Switch(true), 1),
    Setting("trigger_count", ":TRIGger:COUNt", Number(1.0, 1e6, 1.0), 1),
    Setting("plc_v", "[:SENSe]:VOLTage[:DC]:NPLCycles", Number(0.02, 100.0, 10.0), 1),
    Setting("plc_a", "[:SENSe]:CURRent[:DC]:NPLCycles", Number(0.02, 100.0, 10.0), 1),
    Setting("plc_r", "[:SENSe]:RESistance:NPLCycles", Number(0.02, 100.0, 10.0), 1),
    Setting("plc_f", "[:SENSe]:FRESistance:NPLCycles", Number(0.02, 100.0, 10.0), 1),
    Setting("zero_v", "[:SENSe]:VOLTage[:DC]:ZERO:AUTO", Switch(true), 1),
    Setting("zero_a", "[:SENSe]:CURRent[:DC]:ZERO:AUTO", Switch(true), 1),
    Setting("display", ":DISPlay[:STATe]", Switch(true), 1),
    Setting("terminals", ":ROUTe:TERMinals", Choice(&["FRONt", "REAR"]), 1),
    Setting("beep", ":SYSTem:BEEPer[:IMMediate]", Ignored, 1),
    Setting("beeper", ":SYSTem:BEEPer:STATe", Switch(true), 1),
    Setting("preset", ":STATus:PRESet", Ignored, 1),
];

/// The meter with its function, ranges and readings.
pub(super) struct Multimeter {
    body: Body,
    function: usize,
    /// Upper end of the range of each function; `None` for automatic ranging.
    ranges: [Option<f64>; FUNCTIONS.len()],
    /// Number of readings still to come, and the window of the present one.
    job: Option<(u32, Window)>,
    armed: bool,
    readings: Vec<f64>,
}

impl Multimeter {
    pub(super) fn new(body: Body) -> Self {
        Self {
            body,
            function: 0,
            ranges: [None; FUNCTIONS.len()],
            job: None,
            armed: false,
            readings: Vec::new(),
        }
    }

    fn cycles(&self) -> f64 {
        let key = match FUNCTIONS[self.function].1 {
            "VOLT" => "plc_v",
            "CURR" => "plc_a",
            "RES" => "plc_r",
            "FRES" => "plc_f",
            _ => return 10.0,
        };
        self.body.settings.number(key)
    }

    fn is_ac(&self) -> bool {
        FUNCTIONS[self.function].1.ends_with(":AC")
    }

    fn start(&mut self, now_us: u64, circuit: &mut dyn Circuit) {
        self.stop(circuit);
        self.readings.clear();
        if FUNCTIONS[self.function].1.contains("RES") {
            circuit.drive(self.body.at, OHMS_SOURCE);
        }
        let settings = &self.body.settings;
        let delay_us = (settings.number("trigger_delay_s") * 1e6) as u64;
        let ranging_us = match self.ranges[self.function] {
            None => RANGING_US,
            Some(_) => 0,
        };
        self.job = Some((
            settings.number("count") as u32,
            self.window(now_us + delay_us + ranging_us + TRIGGER_US),
        ));
    }

    /// Aborts the measurement in progress, if any, and disconnects the source of a resistance measurement.
    fn stop(&mut self, circuit: &mut dyn Circuit) {
        if self.job.take().is_some() && FUNCTIONS[self.function].1.contains("RES") {
            circuit.drive(self.body.at, Drive::Open);
        }
        self.armed = false;
    }

    fn window(&self, from_us: u64) -> Window {
        match self.is_ac() {
            true => Window::open(from_us, AC_US, 400),
            false => Window::open(from_us, self.cycles() * 20_000.0, 16),
        }
    }

    fn reading(&mut self, window: &Window) -> f64 {
        let (_, name, steps, errors) = FUNCTIONS[self.function];
        let (mean, rms) = (window.mean(), window.rms());
        let value = match name {
            "VOLT" => mean.volts,
            "CURR" => mean.amps,
            "VOLT:AC" => rms.volts,
            "CURR:AC" => rms.amps,
            _ if mean.amps.abs() < 1e-9 => f64::INFINITY,
            "RES" => mean.volts / mean.amps + LEADS_OHM,
            _ => mean.volts / mean.amps,
        };
        let fits = steps.iter().find(|step| value.abs() <= **step * 1.2);
        let most = steps[steps.len() - 1];
        let range = self.ranges[self.function].unwrap_or(*fits.unwrap_or(&most));
        if value.abs() > 1.2 * range {
            return f64::INFINITY.copysign(value);
        }
        let cycles = self.cycles();
        let noise = if cycles >= 1.0 {
            1e-5 / cycles.sqrt()
        } else {
            4e-4
        };
        let (gain, offset) = match name {
            "VOLT" => (4e-5, 7e-6),
            "CURR" => (5e-4, if range <= 1e-4 { 2.5e-4 } else { 5e-5 }),
            "VOLT:AC" | "CURR:AC" => (1e-3, 4e-4),
            _ => (1e-4, 1e-5),
        };
        let accuracy = Accuracy {
            gain,
            offset: offset * range,
            noise: noise * range,
        };
        match self.is_ac() {
            true => self.body.errors.apply_rms(errors, accuracy, value),
            false => self.body.errors.apply(errors, accuracy, value),
        }
    }

    /// Sets function and range of CONFigure or MEASure.
    fn configure(&mut self, unit: &Unit, circuit: &mut dyn Circuit) -> Result<(), Failure> {
        let function = function_of(&unit.nodes[1..].join(":"));
        let function = function.ok_or(Failure::UNDEFINED_HEADER)?;
        let range = match unit.word(0) {
            Err(_) => None,
            Ok(word) if ["DEF", "DEFAULT", "AUTO"].contains(&word.as_str()) => None,
            Ok(_) => Some(limit(unit, function)?),
        };
        self.stop(circuit);
        self.body.settings.reset();
        self.function = function;
        self.ranges[function] = range;
        Ok(())
    }

    /// Executes the commands that select function and range; returns `None` for any other command.
    fn select(
        &mut self,
        unit: &Unit,
        circuit: &mut dyn Circuit,
    ) -> Result<Option<Outcome>, Failure> {
        let command_us = self.body.command_us;
        if unit.matches("[:SENSe]:FUNCtion[:ON]").is_some() {
            if unit.query {
                let name = FUNCTIONS[self.function].1;
                return Ok(Some(Outcome::Text(format!("\"{name}\""), command_us)));
            }
            let function = function_of(&unit.word(0)?).ok_or(Failure::ILLEGAL_VALUE)?;
            self.stop(circuit);
            self.function = function;
            return Ok(Some(Outcome::Done(CONFIGURE_US)));
        }
        let Some((function, is_auto)) = range_of(unit) else {
            return Ok(None);
        };
        let range = &mut self.ranges[function];
        let most = *FUNCTIONS[function].2.last().unwrap_or(&0.0);
        match (unit.query, is_auto) {
            (true, true) => {
                let auto = u8::from(range.is_none()).to_string();
                return Ok(Some(Outcome::Text(auto, command_us)));
            }
            (true, false) => {
                let text = nr3(range.unwrap_or(most));
                return Ok(Some(Outcome::Text(text, command_us)));
            }
            (false, true) if unit.boolean()? => *range = None,
            (false, true) => *range = range.or(Some(most)),
            (false, false) => *range = Some(limit(unit, function)?),
        }
        Ok(Some(Outcome::Done(command_us)))
    }
}

/// Returns the function of a name such as `VOLT`, `VOLTage:DC` or `FRES`.
fn function_of(name: &str) -> Option<usize> {
    let name = match name.contains(':') || name.contains("RES") {
        true => name.to_owned(),
        false => format!("{name}:DC"),
    };
    let nodes = Unit {
        nodes: name.split(':').map(str::to_owned).collect(),
        query: false,
        parameters: Vec::new(),
    };
    let named = |(pattern, ..): &(&str, _, _, _)| nodes.matches(pattern).is_some();
    FUNCTIONS.iter().position(named)
}

/// Returns the function whose range a header sets, and whether the header switches automatic ranging.
fn range_of(unit: &Unit) -> Option<(usize, bool)> {
    let all = FUNCTIONS.iter().enumerate();
    all.flat_map(|(function, it)| [(function, it.0, true), (function, it.0, false)])
        .find(|(_, pattern, is_auto)| {
            let name = match pattern.strip_suffix(":DC") {
                Some(stem) => format!("{stem}[:DC]"),
                None => (*pattern).to_owned(),
            };
            let rest = if *is_auto { ":AUTO" } else { "[:UPPer]" };
            let header = format!("[:SENSe]:{name}:RANGe{rest}");
            unit.matches(&header).is_some()
        })
        .map(|(function, _, is_auto)| (function, is_auto))
}

/// Returns the smallest range that holds the first parameter of the unit.
fn limit(unit: &Unit, function: usize) -> Result<f64, Failure> {
    let steps = FUNCTIONS[function].2;
    let most = steps[steps.len() - 1];
    let wanted = unit.number(0, 0.0, most, most)?;
    let fits = steps.iter().find(|step| wanted <= **step * 1.0001);
    Ok(fits.copied().unwrap_or(most))
}

impl Instrument for Multimeter {
    fn body(&mut self) -> &mut Body {
        &mut self.body
    }

    fn reset(&mut self, at: &mut Moment<'_>) -> u64 {
        self.stop(at.circuit);
        self.body.settings.reset();
        self.function = 0;
        self.ranges = [None; FUNCTIONS.len()];
        self.readings.clear();
        60_000
    }

    fn changed(&mut self, _: Changed, _: &mut Moment<'_>) -> Result<u64, Failure> {
        Ok(0)
    }

    fn perform(&mut self, unit: &Unit, at: &mut Moment<'_>) -> Result<Outcome, Failure> {
        if let Some(outcome) = self.select(unit, at.circuit)? {
            return Ok(outcome);
        }
        let has = |pattern| unit.matches(pattern).is_some();
        let heads = |word| unit.nodes.len() > 1 && unit.nodes[0].starts_with(word);
        let immediate = self.body.settings.choice("trigger") == "IMMediate";
        let done = Outcome::Done(self.body.command_us);
        match unit.query {
            false if heads("CONF") => {
                self.configure(unit, at.circuit)?;
                Ok(Outcome::Done(CONFIGURE_US))
            }
            true if has(":CONFigure") => {
                let name = FUNCTIONS[self.function].1;
                let range = self.ranges[self.function].unwrap_or(10.0);
                let text = format!("\"{name} {},{}\"", nr3(range), nr3(3e-7 * range));
                Ok(Outcome::Text(text, self.body.command_us))
            }
            true if heads("MEAS") => {
                self.configure(unit, at.circuit)?;
                self.start(at.now_us + CONFIGURE_US, at.circuit);
                Ok(Outcome::AfterJob)
            }
            true if has(":READ") && immediate => {
                self.start(at.now_us, at.circuit);
                Ok(Outcome::AfterJob)
            }
            true if has(":READ") => Err(Failure::TRIGGER_DEADLOCK),
            true if has(":FETCh") => Ok(Outcome::AfterJob),
            false if has(":INITiate[:IMMediate]") && self.job.is_some() => {
                Err(Failure::INIT_IGNORED)
            }
            false if has(":INITiate[:IMMediate]") => {
                match immediate {
                    true => self.start(at.now_us, at.circuit),
                    false => self.armed = true,
                }
                Ok(done)
            }
            false if has("*TRG") && self.armed => {
                self.start(at.now_us, at.circuit);
                Ok(done)
            }
            false if has("*TRG") => Err(Failure::TRIGGER_IGNORED),
            false if has(":ABORt") => {
                self.stop(at.circuit);
                Ok(done)
            }
            true | false => Err(Failure::UNDEFINED_HEADER),
        }
    }

    fn fetch(&mut self, _: &Unit) -> Result<Outcome, Failure> {
        if self.readings.is_empty() {
            return Err(Failure::DATA_STALE);
        }
        let texts: Vec<String> = self.readings.iter().map(|read| nr3(*read)).collect();
        Ok(Outcome::Text(texts.join(","), 0))
    }

    fn next_us(&self) -> Option<u64> {
        self.job.map(|(_, window)| window.next_us())
    }

    fn end_us(&self) -> Option<u64> {
        Some(self.job?.1.end_us())
    }

    fn tick(&mut self, at: &mut Moment<'_>) {
        let Some((left, window)) = &mut self.job else {
            return;
        };
        if !window.take(at.circuit.at(self.body.at)) {
            return;
        }
        let (left, window) = (*left - 1, *window);
        let read = self.reading(&window);
        self.readings.push(read);
        match left {
            0 => self.stop(at.circuit),
            left => self.job = Some((left, self.window(at.now_us))),
        }
    }
}
