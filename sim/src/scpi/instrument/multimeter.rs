//! Multimeter of the 34461A class.

use std::ops::ControlFlow;

use super::settings::{Kind, Setting, Settings};
use super::{Accuracy, Body, Instrument, Outcome, Window};
use crate::scpi::circuit::{Circuit, Drive, Terminal};
use crate::scpi::message::{Unit, nr3};
use crate::scpi::status::Failure;

const COMMAND_US: u64 = 500;
/// Time of a change of function, microseconds.
const CONFIGURE_US: u64 = 40_000;
/// Window of an AC measurement: ten cycles of 50 Hz, microseconds.
const AC_US: f64 = 200_000.0;

/// Functions by header after CONFigure or MEASure, with their choice of the setting, ranges and index of errors.
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

/// The meter with its function, range and readings.
pub(super) struct Multimeter {
    body: Body,
    at: Terminal,
    settings: Settings,
    function: usize,
    /// Upper end of the range; `None` chooses it by the reading.
    range: Option<f64>,
    job: Option<(u32, Window)>,
    armed: bool,
    readings: Vec<f64>,
}

impl Multimeter {
    pub(super) fn new(body: Body, at: Terminal) -> Self {
        let settings = Settings::new(TABLE);
        let readings = Vec::new();
        Self {
            body,
            at,
            settings,
            function: 0,
            range: None,
            job: None,
            armed: false,
            readings,
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
        self.settings.number(key)
    }

    fn is_ac(&self) -> bool {
        FUNCTIONS[self.function].1.ends_with(":AC")
    }

    fn start(&mut self, now_us: u64, circuit: &mut dyn Circuit) {
        self.readings.clear();
        if FUNCTIONS[self.function].1.contains("RES") {
            circuit.drive(
                self.at,
                Drive::Current {
                    amps: 1e-3,
                    limit_v: 12.0,
                },
            );
        }
        let delay_us = (self.settings.number("trigger_delay_s") * 1e6) as u64;
        let auto_us = if self.range.is_none() { 10_000 } else { 0 };
        self.job = Some((
            self.settings.number("count") as u32,
            self.window(now_us + delay_us + auto_us + 300),
        ));
    }

    fn window(&self, from_us: u64) -> Window {
        match self.is_ac() {
            true => Window::open(from_us, AC_US, 400),
            false => Window::open(from_us, self.cycles() * 20_000.0, 16),
        }
    }

    fn reading(&mut self, window: &Window) -> f64 {
        let (_, name, steps, errors) = FUNCTIONS[self.function];
        let value = match name {
            "VOLT" => window.mean().volts,
            "CURR" => window.mean().amps,
            "VOLT:AC" => window.rms().volts,
            "CURR:AC" => window.rms().amps,
            name => {
                let (mean, leads) = (window.mean(), if name == "RES" { 0.2 } else { 0.0 });
                if mean.amps.abs() < 1e-9 {
                    9.9e37
                } else {
                    mean.volts / mean.amps + leads
                }
            }
        };
        let fits = steps
            .iter()
            .find(|step| value.abs() <= **step * 1.2)
            .copied();
        let range = self.range.or(fits).unwrap_or(steps[steps.len() - 1]);
        if value.abs() > 1.2 * range {
            return 9.9e37_f64.copysign(value);
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
        self.body.errors.apply(errors, accuracy, value)
    }

    /// Sets function and range of CONFigure or MEASure.
    fn configure(&mut self, unit: &Unit) -> Result<(), Failure> {
        let name = unit.nodes[1..].join(":");
        let with_dc = if name.contains(':') || name.contains("RES") {
            name.clone()
        } else {
            format!("{name}:DC")
        };
        let nodes = Unit {
            nodes: with_dc.split(':').map(str::to_owned).collect(),
            ..unit.clone()
        };
        let found = FUNCTIONS
            .iter()
            .position(|(pattern, ..)| nodes.matches(pattern).is_some());
        self.function = found.ok_or(Failure::UNDEFINED_HEADER)?;
        self.settings.reset();
        self.range = match unit.parameters.first() {
            Some(word)
                if !["DEF", "AUTO"]
                    .iter()
                    .any(|it| word.eq_ignore_ascii_case(it.as_bytes())) =>
            {
                Some(self.limit(unit)?)
            }
            Some(_) | None => None,
        };
        Ok(())
    }

    fn limit(&self, unit: &Unit) -> Result<f64, Failure> {
        let steps = FUNCTIONS[self.function].2;
        let most = steps[steps.len() - 1];
        let wanted = unit.number(0, 0.0, most, most)?;
        let fits = steps.iter().find(|step| wanted <= **step * 1.0001);
        Ok(fits.copied().unwrap_or(most))
    }

    /// Executes the commands of function and range.
    fn select(&mut self, unit: &Unit) -> Result<Option<Outcome>, Failure> {
        if unit.matches("[:SENSe]:FUNCtion[:ON]").is_some() {
            if unit.query {
                let name = FUNCTIONS[self.function].1;
                return Ok(Some(Outcome::Text(format!("\"{name}\""), COMMAND_US)));
            }
            let word = unit.word(0)?;
            let word = word.strip_suffix(":DC").unwrap_or(&word);
            let known = |it: &(&str, &str, _, _)| it.1 == word || it.0.eq_ignore_ascii_case(word);
            let found = FUNCTIONS.iter().position(known);
            self.function = found.ok_or(Failure::ILLEGAL_VALUE)?;
            self.range = None;
            return Ok(Some(Outcome::Done(CONFIGURE_US)));
        }
        for (function, (pattern, ..)) in FUNCTIONS.iter().enumerate() {
            let stem = pattern.strip_suffix(":DC").unwrap_or(pattern);
            let dc = if stem.len() < pattern.len() {
                "[:DC]"
            } else {
                ""
            };
            let is = |rest| {
                unit.matches(&format!("[:SENSe]:{stem}{dc}:RANGe{rest}"))
                    .is_some()
            };
            if is(":AUTO") {
                if unit.query {
                    let auto = u8::from(self.range.is_none());
                    return Ok(Some(Outcome::Text(auto.to_string(), COMMAND_US)));
                }
                self.function = function;
                let most = FUNCTIONS[function].2.last().copied();
                self.range = if unit.boolean()? {
                    None
                } else {
                    self.range.or(most)
                };
                return Ok(Some(Outcome::Done(COMMAND_US)));
            }
            if is("[:UPPer]") {
                if unit.query {
                    let most = FUNCTIONS[function].2.last().copied();
                    let range = self.range.or(most).unwrap_or_default();
                    return Ok(Some(Outcome::Text(nr3(range), COMMAND_US)));
                }
                self.function = function;
                self.range = Some(self.limit(unit)?);
                return Ok(Some(Outcome::Done(COMMAND_US)));
            }
        }
        Ok(None)
    }
}

impl Instrument for Multimeter {
    fn body(&mut self) -> &mut Body {
        &mut self.body
    }

    fn reset(&mut self, _now_us: u64) -> u64 {
        self.settings.reset();
        self.function = 0;
        self.range = None;
        self.job = None;
        self.armed = false;
        self.readings.clear();
        60_000
    }

    fn execute(
        &mut self,
        unit: &Unit,
        now_us: u64,
        circuit: &mut dyn Circuit,
    ) -> Result<Outcome, Failure> {
        match self.settings.execute(unit)? {
            ControlFlow::Break(Ok(text)) => return Ok(Outcome::Text(text, COMMAND_US)),
            ControlFlow::Break(Err(_)) => return Ok(Outcome::Done(COMMAND_US)),
            ControlFlow::Continue(()) => {}
        }
        if let Some(outcome) = self.select(unit)? {
            return Ok(outcome);
        }
        let has = |pattern| unit.matches(pattern).is_some();
        let heads = |word| unit.nodes.len() > 1 && unit.nodes[0].starts_with(word);
        let immediate = self.settings.choice("trigger") == "IMMediate";
        match unit.query {
            false if heads("CONF") => {
                self.configure(unit)?;
                Ok(Outcome::Done(CONFIGURE_US))
            }
            true if has(":CONFigure") => {
                let name = FUNCTIONS[self.function].1;
                let range = self.range.map_or("+1.00000000E+01".into(), nr3);
                Ok(Outcome::Text(
                    format!("\"{name} {range},+3.00000000E-06\""),
                    COMMAND_US,
                ))
            }
            true if heads("MEAS") => {
                self.configure(unit)?;
                self.start(now_us + CONFIGURE_US, circuit);
                Ok(Outcome::AfterJob)
            }
            true if has(":READ") && immediate => {
                self.start(now_us, circuit);
                Ok(Outcome::AfterJob)
            }
            true if has(":READ") => Err(Failure::SETTINGS_CONFLICT),
            true if has(":FETCh") => Ok(Outcome::AfterJob),
            false if has(":INITiate[:IMMediate]") && self.job.is_some() => {
                Err(Failure::INIT_IGNORED)
            }
            false if has(":INITiate[:IMMediate]") => {
                match immediate {
                    true => self.start(now_us, circuit),
                    false => self.armed = true,
                }
                Ok(Outcome::Done(COMMAND_US))
            }
            false if has("*TRG") && std::mem::take(&mut self.armed) => {
                self.start(now_us, circuit);
                Ok(Outcome::Done(COMMAND_US))
            }
            false if has("*TRG") => Err(Failure::TRIGGER_IGNORED),
            false if has(":ABORt") => {
                self.job = None;
                self.armed = false;
                Ok(Outcome::Done(COMMAND_US))
            }
            true | false => Err(Failure::UNDEFINED_HEADER),
        }
    }

    fn fetch(&mut self, _: &Unit, _: u64, _: &mut dyn Circuit) -> Result<Outcome, Failure> {
        if self.readings.is_empty() {
            return Err(Failure::DATA_STALE);
        }
        let texts: Vec<String> = self.readings.iter().map(|read| nr3(*read)).collect();
        Ok(Outcome::Text(texts.join(","), 0))
    }

    fn next_us(&self) -> Option<u64> {
        self.job.map(|(_, window)| window.next_us)
    }

    fn end_us(&self) -> Option<u64> {
        Some(self.job?.1.end_us())
    }

    fn tick(&mut self, now_us: u64, circuit: &mut dyn Circuit) {
        let Some((left, window)) = &mut self.job else {
            return;
        };
        if !window.take(circuit.at(self.at)) {
            return;
        }
        let (left, window) = (*left - 1, *window);
        let read = self.reading(&window);
        self.readings.push(read);
        self.job = (left > 0).then(|| (left, self.window(now_us)));
        if left == 0 && FUNCTIONS[self.function].1.contains("RES") {
            circuit.drive(self.at, Drive::Open);
        }
    }
}
