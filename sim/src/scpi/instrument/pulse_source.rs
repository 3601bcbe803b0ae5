//! Function generator that sends pulses with an exact period.

use std::ops::ControlFlow;

use super::settings::{Kind, Setting, Settings};
use super::{Accuracy, Body, Instrument, Outcome};
use crate::scpi::circuit::{Circuit, Drive, Pulses, Terminal};
use crate::scpi::message::Unit;
use crate::scpi::status::Failure;

const COMMAND_US: u64 = 4_000;

use Kind::{Choice, Number, Switch};
#[rustfmt::skip]
const TABLE: &[Setting] = &[
    Setting("shape", "[:SOURce#]:FUNCtion[:SHAPe]", Choice(&["SINusoid", "SQUare", "PULSe", "DC"]), 1),
    Setting("hz", "[:SOURce#]:FREQuency[:CW]", Number(1e-6, 2e7, 1e3), 1),
    Setting("period_s", "[:SOURce#]:PULSe:PERiod", Number(2e-7, 2e3, 1e-3), 1),
    Setting("pulse_period_s", "[:SOURce#]:FUNCtion:PULSe:PERiod", Number(2e-7, 2e3, 1e-3), 1),
    Setting("width_s", "[:SOURce#]:FUNCtion:PULSe:WIDTh", Number(2e-8, 2e3, 1e-4), 1),
    Setting("edge_s", "[:SOURce#]:FUNCtion:PULSe:TRANsition", Number(5e-9, 1e-7, 5e-9), 1),
    Setting("high_v", "[:SOURce#]:VOLTage:HIGH", Number(-10.0, 10.0, 0.05), 1),
    Setting("low_v", "[:SOURce#]:VOLTage:LOW", Number(-10.0, 10.0, -0.05), 1),
    Setting("peak_v", "[:SOURce#]:VOLTage", Number(0.01, 20.0, 0.1), 1),
    Setting("offset_v", "[:SOURce#]:VOLTage:OFFSet", Number(-10.0, 10.0, 0.0), 1),
    Setting("duty_pct", "[:SOURce#]:FUNCtion:SQUare:DCYCle", Number(20.0, 80.0, 50.0), 1),
    Setting("load", ":OUTPut:LOAD", Number(1.0, 9.9e37, 50.0), 1),
    Setting("polarity", ":OUTPut:POLarity", Choice(&["NORMal", "INVerted"]), 1),
    Setting("output", ":OUTPut[:STATe]", Switch(false), 1),
    Setting("burst", "[:SOURce#]:BURSt:STATe", Switch(false), 1),
    Setting("burst_mode", "[:SOURce#]:BURSt:MODE", Choice(&["TRIGgered", "GATed"]), 1),
    Setting("cycles", "[:SOURce#]:BURSt:NCYCles", Number(1.0, 50_000.0, 1.0), 1),
    Setting("phase_deg", "[:SOURce#]:BURSt:PHASe", Number(-360.0, 360.0, 0.0), 1),
    Setting("trigger", ":TRIGger:SOURce", Choice(&["IMMediate", "EXTernal", "BUS"]), 1),
];

/// The generator with its settings.
pub(super) struct PulseSource {
    body: Body,
    at: Terminal,
    settings: Settings,
    /// Instant at which a reset disconnects the output, or at which a burst ends.
    event_us: Option<(u64, Event)>,
}

#[derive(Clone, Copy, PartialEq)]
enum Event {
    Disconnect,
    BurstEnds,
}

impl PulseSource {
    pub(super) fn new(body: Body, at: Terminal) -> Self {
        Self {
            body,
            at,
            settings: Settings::new(TABLE),
            event_us: None,
        }
    }

    fn pulses(&mut self, count: Option<u64>) -> Pulses {
        let accuracy = Accuracy {
            gain: 0.0,
            offset: 2e-3,
            noise: 0.0,
        };
        let (high_v, low_v) = (
            self.settings.number("high_v"),
            self.settings.number("low_v"),
        );
        let high_v = self.body.errors.apply(0, accuracy, high_v);
        let low_v = self.body.errors.apply(1, accuracy, low_v);
        let period_us = self.settings.number("period_s") * 1e6;
        let width_us = match self.settings.choice("shape") {
            "SQUare" => period_us * self.settings.number("duty_pct") / 100.0,
            _ => self.settings.number("width_s") * 1e6,
        };
        Pulses {
            low_v,
            high_v,
            period_us,
            width_us: width_us.min(period_us),
            count,
        }
    }

    /// Connects the output: continuous pulses, the level between pulses, a constant voltage, or nothing.
    fn drive(&mut self, circuit: &mut dyn Circuit) {
        let settings = &self.settings;
        let drive = if !settings.on("output") {
            Drive::Open
        } else if settings.choice("shape") == "DC" {
            Drive::Voltage {
                volts: settings.number("offset_v"),
                limit_a: 0.1,
            }
        } else if settings.on("burst") {
            Drive::Pulses(self.pulses(Some(0)))
        } else {
            Drive::Pulses(self.pulses(None))
        };
        circuit.drive(self.at, drive);
    }

    fn burst(&mut self, now_us: u64, circuit: &mut dyn Circuit) {
        let cycles = self.settings.number("cycles").round();
        let pulses = self.pulses(Some(cycles as u64));
        let ends_us = now_us + (pulses.period_us * cycles).ceil() as u64;
        self.event_us = Some((ends_us, Event::BurstEnds));
        circuit.drive(self.at, Drive::Pulses(pulses));
    }

    /// Keeps settings consistent that two commands reach.
    fn follow(&mut self, key: &str) -> Result<(), Failure> {
        let settings = &mut self.settings;
        let number = |settings: &Settings, key| settings.number(key);
        match key {
            "hz" => {
                let period_s = 1.0 / number(settings, "hz");
                settings.set("period_s", period_s);
            }
            "pulse_period_s" => {
                let period_s = number(settings, "pulse_period_s");
                settings.set("period_s", period_s);
            }
            "peak_v" | "offset_v" => {
                let (peak, offset) = (number(settings, "peak_v"), number(settings, "offset_v"));
                settings.set("high_v", offset + peak / 2.0);
                settings.set("low_v", offset - peak / 2.0);
            }
            "high_v" | "low_v" => {
                let (high, low) = (number(settings, "high_v"), number(settings, "low_v"));
                settings.set("peak_v", high - low);
                settings.set("offset_v", (high + low) / 2.0);
                if high <= low {
                    return Err(Failure::SETTINGS_CONFLICT);
                }
            }
            _ => {}
        }
        let period_s = settings.number("period_s");
        settings.set("hz", 1.0 / period_s);
        settings.set("pulse_period_s", period_s);
        match settings.number("width_s") > period_s {
            true => Err(Failure::SETTINGS_CONFLICT),
            false => Ok(()),
        }
    }
}

impl Instrument for PulseSource {
    fn body(&mut self) -> &mut Body {
        &mut self.body
    }

    fn reset(&mut self, now_us: u64) -> u64 {
        self.settings.reset();
        self.event_us = Some((now_us, Event::Disconnect));
        100_000
    }

    fn execute(
        &mut self,
        unit: &Unit,
        now_us: u64,
        circuit: &mut dyn Circuit,
    ) -> Result<Outcome, Failure> {
        match self.settings.execute(unit)? {
            ControlFlow::Break(Ok(text)) => return Ok(Outcome::Text(text, COMMAND_US)),
            ControlFlow::Break(Err((key, _))) => {
                let consistent = self.follow(key);
                self.drive(circuit);
                return consistent.map(|()| Outcome::Done(COMMAND_US));
            }
            ControlFlow::Continue(()) => {}
        }
        let triggers = unit
            .matches("*TRG")
            .or(unit.matches(":TRIGger[:IMMediate]"))
            .is_some();
        if unit.query || !triggers {
            return Err(Failure::UNDEFINED_HEADER);
        }
        let ready = self.settings.on("output") && self.settings.on("burst");
        if !ready || self.event_us.is_some() {
            return Err(Failure::TRIGGER_IGNORED);
        }
        self.burst(now_us, circuit);
        Ok(Outcome::Done(COMMAND_US))
    }

    fn fetch(&mut self, _: &Unit, _: u64, _: &mut dyn Circuit) -> Result<Outcome, Failure> {
        Err(Failure::DATA_STALE)
    }

    fn next_us(&self) -> Option<u64> {
        self.event_us.map(|(at_us, _)| at_us)
    }

    fn tick(&mut self, _: u64, circuit: &mut dyn Circuit) {
        if let Some((_, Event::Disconnect)) = self.event_us.take() {
            self.drive(circuit);
        }
    }
}
