//! AC source of the 61500 class.

use std::ops::ControlFlow;

use super::settings::{Kind, Setting, Settings};
use super::{Accuracy, Body, Instrument, Outcome, Window};
use crate::scpi::circuit::{Circuit, Drive, Terminal};
use crate::scpi::message::{Unit, nr3};
use crate::scpi::status::Failure;

const COMMAND_US: u64 = 5_000;
/// Time of `*RST`, microseconds.
const RESET_US: u64 = 7_000_000;
/// Cycles and samples of a measurement.
const CYCLES: f64 = 5.0;
const SAMPLES: u32 = 500;

use Kind::{Choice, Number, Switch};
#[rustfmt::skip]
const TABLE: &[Setting] = &[
    Setting("volts", "[:SOURce]:VOLTage[:LEVel][:IMMediate][:AMPLitude]:AC", Number(0.0, 300.0, 0.0), 1),
    Setting("limit_v", "[:SOURce]:VOLTage:LIMit:AC", Number(0.0, 300.0, 300.0), 1),
    Setting("volt_range", "[:SOURce]:VOLTage:RANGe", Choice(&["HIGH", "LOW", "AUTO"]), 1),
    Setting("hz", "[:SOURce]:FREQuency[:CW]", Number(15.0, 1000.0, 60.0), 1),
    Setting("hz_limit", "[:SOURce]:FREQuency:LIMit", Number(15.0, 1000.0, 1000.0), 1),
    Setting("limit_a", "[:SOURce]:CURRent:LIMit", Number(0.0, 18.0, 18.0), 1),
    Setting("limit_delay_s", "[:SOURce]:CURRent:DELay", Number(0.0, 5.0, 0.0), 1),
    Setting("phase_on", "[:SOURce]:PHASe:ON", Number(0.0, 360.0, 0.0), 1),
    Setting("phase_off", "[:SOURce]:PHASe:OFF", Number(0.0, 360.0, 360.0), 1),
    Setting("shape", "[:SOURce]:FUNCtion:SHAPe", Choice(&["A", "B"]), 1),
    Setting("output", ":OUTPut[:STATe]", Switch(false), 1),
    Setting("coupling", ":OUTPut:COUPling", Choice(&["AC", "DC", "ACDC"]), 1),
    Setting("mode", ":OUTPut:MODE", Choice(&["FIXed", "LIST", "PULSe", "STEP"]), 1),
];

/// The source with its output and a measurement in work.
pub(super) struct AcSource {
    body: Body,
    at: Terminal,
    settings: Settings,
    job: Option<Window>,
    last: Option<Window>,
    /// Instant at which the output goes off after a command, at the programmed phase.
    off_us: Option<u64>,
    started_us: u64,
}

impl AcSource {
    pub(super) fn new(body: Body, at: Terminal) -> Self {
        let settings = Settings::new(TABLE);
        Self {
            body,
            at,
            settings,
            job: None,
            last: None,
            off_us: None,
            started_us: 0,
        }
    }

    fn drive(&mut self, now_us: u64, circuit: &mut dyn Circuit, restart: bool) {
        let settings = &self.settings;
        if !settings.on("output") {
            circuit.drive(self.at, Drive::Open);
            return;
        }
        let volts = settings.number("volts");
        let hz = settings.number("hz");
        if restart {
            self.started_us = now_us;
        }
        let cycles = (now_us - self.started_us) as f64 * 1e-6 * hz;
        let on = settings.number("phase_on") % 360.0;
        let phase_deg = (on + 360.0 * cycles) % 360.0;
        let limit_a = settings.number("limit_a");
        let accuracy = Accuracy {
            gain: 2e-3,
            offset: 0.3,
            noise: 0.0,
        };
        let rms_v = match volts {
            0.0 => 0.0,
            volts => self.body.errors.apply(0, accuracy, volts).max(0.0),
        };
        circuit.drive(
            self.at,
            Drive::Sine {
                rms_v,
                hz,
                phase_deg,
                limit_a,
            },
        );
    }

    /// Returns the instant at which the output reaches the phase at which it goes off.
    fn off_at(&self, now_us: u64) -> u64 {
        let phase_off = self.settings.number("phase_off");
        if phase_off >= 360.0 {
            return now_us;
        }
        let hz = self.settings.number("hz");
        let on = self.settings.number("phase_on");
        let turned = (on + (now_us - self.started_us) as f64 * 360e-6 * hz) % 360.0;
        now_us + ((phase_off - turned).rem_euclid(360.0) / (360e-6 * hz)) as u64
    }
}

impl Instrument for AcSource {
    fn body(&mut self) -> &mut Body {
        &mut self.body
    }

    fn reset(&mut self, now_us: u64) -> u64 {
        self.settings.reset();
        self.job = None;
        self.off_us = Some(now_us);
        RESET_US
    }

    fn execute(
        &mut self,
        unit: &Unit,
        now_us: u64,
        circuit: &mut dyn Circuit,
    ) -> Result<Outcome, Failure> {
        let was_on = self.settings.on("output");
        let was_v = self.settings.number("volts");
        match self.settings.execute(unit)? {
            ControlFlow::Break(Ok(text)) => return Ok(Outcome::Text(text, COMMAND_US)),
            ControlFlow::Break(Err(("volts", _)))
                if self.settings.number("volts") > self.settings.number("limit_v") =>
            {
                self.settings.set("volts", was_v);
                return Err(Failure::OUT_OF_RANGE);
            }
            ControlFlow::Break(Err(("output", _))) if was_on && !self.settings.on("output") => {
                self.off_us = Some(self.off_at(now_us));
                return Ok(Outcome::Done(COMMAND_US));
            }
            ControlFlow::Break(Err(("output" | "volts" | "hz" | "limit_a", _))) => {
                self.off_us = None;
                self.drive(now_us, circuit, !was_on);
                return Ok(Outcome::Done(COMMAND_US));
            }
            ControlFlow::Break(Err(_)) => return Ok(Outcome::Done(COMMAND_US)),
            ControlFlow::Continue(()) => {}
        }
        let has = |pattern| unit.matches(pattern).is_some();
        match unit.query {
            true if measured(unit).is_some() => {
                let window_us = CYCLES * 1e6 / self.settings.number("hz");
                self.job = Some(Window::open(now_us, window_us, SAMPLES));
                Ok(Outcome::AfterJob)
            }
            true if has(":STATus:QUEStionable:CONDition") => {
                Ok(Outcome::Text("0".into(), COMMAND_US))
            }
            false if has(":ABORt") => {
                self.job = None;
                Ok(Outcome::Done(COMMAND_US))
            }
            true | false => Err(Failure::UNDEFINED_HEADER),
        }
    }

    fn fetch(&mut self, unit: &Unit, _: u64, _: &mut dyn Circuit) -> Result<Outcome, Failure> {
        let window = self.last.ok_or(Failure::DATA_STALE)?;
        let rms = window.rms();
        let power = window.power / f64::from(window.count.max(1));
        let (function, value, offset) = match measured(unit).ok_or(Failure::UNDEFINED_HEADER)? {
            Measured::Volts => (1, rms.volts, 0.6),
            Measured::Amps => (2, rms.amps, 0.02),
            Measured::Watts => (3, power, 1.0),
            Measured::Hertz => {
                let hz = if self.settings.on("output") {
                    self.settings.number("hz")
                } else {
                    0.0
                };
                return Ok(Outcome::Text(nr3(hz), 0));
            }
        };
        let accuracy = Accuracy {
            gain: 2e-3,
            offset,
            noise: 0.02 * offset,
        };
        Ok(Outcome::Text(
            nr3(self.body.errors.apply(function, accuracy, value)),
            0,
        ))
    }

    fn next_us(&self) -> Option<u64> {
        let window = self.job.map(|window| window.next_us);
        [window, self.off_us].into_iter().flatten().min()
    }

    fn end_us(&self) -> Option<u64> {
        Some(self.job?.end_us())
    }

    fn tick(&mut self, now_us: u64, circuit: &mut dyn Circuit) {
        if self.off_us.is_some_and(|off_us| off_us <= now_us) {
            self.off_us = None;
            circuit.drive(self.at, Drive::Open);
            return;
        }
        if let Some(window) = &mut self.job
            && window.take(circuit.at(self.at))
        {
            self.last = self.job.take();
        }
    }
}

enum Measured {
    Volts,
    Amps,
    Watts,
    Hertz,
}

fn measured(unit: &Unit) -> Option<Measured> {
    let has = |quantity: &str| {
        let measure = format!(":MEASure[:SCALar]:{quantity}");
        let fetch = format!(":FETCh[:SCALar]:{quantity}");
        unit.matches(&measure).or(unit.matches(&fetch)).is_some()
    };
    [
        ("VOLTage[:AC]", Measured::Volts),
        ("CURRent[:AC]", Measured::Amps),
        ("POWer[:AC][:REAL]", Measured::Watts),
        ("FREQuency", Measured::Hertz),
    ]
    .into_iter()
    .find_map(|(quantity, what)| has(quantity).then_some(what))
}
