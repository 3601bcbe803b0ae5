//! Function generator that sends pulses with an exact period. With a shape other than pulse, square or DC the output
//! stays off.

use super::errors::Accuracy;
use super::settings::{Changed, Kind, Setting, Settings};
use super::{Body, Instrument, Kit, Moment, Outcome};
use crate::scpi::circuit::{Circuit, Drive, Pulses, Terminal};
use crate::scpi::message::Unit;
use crate::scpi::status::Failure;

/// Resistance of the output, ohms.
const SOURCE_OHM: f64 = 50.0;

pub(super) const KIT: Kit = Kit {
    identity: "Agilent Technologies,33220A,MY44001234,2.07-2.06-22-2",
    latency_us: 5_000,
    command_us: 4_000,
    at: Terminal::Pulse,
    settings: TABLE,
};

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

/// Settings in volts, as they appear over the configured load.
const VOLTS: [&str; 4] = ["high_v", "low_v", "peak_v", "offset_v"];

/// The generator with its settings.
pub(super) struct PulseSource {
    body: Body,
    /// Instant at which the present burst ends.
    burst_end_us: Option<u64>,
}

impl PulseSource {
    pub(super) fn new(body: Body) -> Self {
        Self {
            body,
            burst_end_us: None,
        }
    }

    fn pulses(&mut self, count: Option<u64>) -> Pulses {
        let accuracy = Accuracy {
            gain: 0.0,
            offset: 2e-3,
            noise: 0.0,
        };
        let Body {
            settings, errors, ..
        } = &mut self.body;
        let open = open_circuit(settings.number("load"));
        let high_v = open * errors.apply(0, accuracy, settings.number("high_v"));
        let low_v = open * errors.apply(1, accuracy, settings.number("low_v"));
        let (high_v, low_v) = match settings.choice("polarity") {
            "INVerted" => (low_v, high_v),
            _ => (high_v, low_v),
        };
        let period_us = settings.number("period_s") * 1e6;
        let width_us = match settings.choice("shape") {
            "SQUare" => period_us * settings.number("duty_pct") / 100.0,
            _ => settings.number("width_s") * 1e6,
        };
        Pulses {
            low_v,
            high_v,
            period_us,
            width_us: width_us.min(period_us),
            // The clock of the generator is its own: its edges lie anywhere between two microseconds of the rig.
            delay_us: errors.fraction(),
            count,
            source_ohm: SOURCE_OHM,
        }
    }

    /// Connects the output: continuous pulses, the level between pulses, a constant voltage, or nothing.
    fn drive(&mut self, circuit: &mut dyn Circuit) {
        let settings = &self.body.settings;
        let drive = match settings.choice("shape") {
            _ if !settings.on("output") => Drive::Open,
            "SINusoid" => Drive::Open,
            "DC" => Drive::Voltage {
                volts: open_circuit(settings.number("load")) * settings.number("offset_v"),
                limit_a: f64::INFINITY,
                source_ohm: SOURCE_OHM,
            },
            _ if settings.on("burst") => Drive::Pulses(self.pulses(Some(0))),
            _ => Drive::Pulses(self.pulses(None)),
        };
        self.burst_end_us = None;
        circuit.drive(self.body.at, drive);
    }

    fn burst(&mut self, now_us: u64, circuit: &mut dyn Circuit) {
        let cycles = self.body.settings.number("cycles").round();
        let pulses = self.pulses(Some(cycles as u64));
        self.burst_end_us =
            Some(now_us + (pulses.delay_us + pulses.period_us * cycles).ceil() as u64);
        circuit.drive(self.body.at, Drive::Pulses(pulses));
    }

    /// Updates the settings that state the changed quantity in another way: frequency and period, levels and peak with
    /// offset.
    fn follow(&mut self, Changed { key, before, .. }: Changed) -> Result<(), Failure> {
        let settings = &mut self.body.settings;
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
            // The output voltage stays as it is; the settings change to the volts over the load now configured.
            "load" => {
                let ratio = open_circuit(before) / open_circuit(number(settings, "load"));
                for key in VOLTS {
                    settings.set(key, ratio * number(settings, key));
                }
            }
            _ => {}
        }
        let period_s = settings.number("period_s");
        settings.set("hz", 1.0 / period_s);
        settings.set("pulse_period_s", period_s);
        let is_sine = settings.choice("shape") == "SINusoid" && settings.on("output");
        match settings.number("width_s") > period_s || is_sine {
            true => Err(Failure::SETTINGS_CONFLICT),
            false => Ok(()),
        }
    }
}

/// Returns the open-circuit voltage divided by the voltage over a load.
fn open_circuit(load_ohm: f64) -> f64 {
    1.0 + SOURCE_OHM / load_ohm
}

impl Instrument for PulseSource {
    fn body(&mut self) -> &mut Body {
        &mut self.body
    }

    fn reset(&mut self, at: &mut Moment<'_>) -> u64 {
        self.body.settings.reset();
        self.drive(at.circuit);
        100_000
    }

    fn changed(&mut self, changed: Changed, at: &mut Moment<'_>) -> Result<u64, Failure> {
        let consistent = self.follow(changed);
        self.drive(at.circuit);
        consistent.map(|()| 0)
    }

    fn perform(&mut self, unit: &Unit, at: &mut Moment<'_>) -> Result<Outcome, Failure> {
        let has = |pattern| unit.matches(pattern).is_some();
        if unit.query || !(has("*TRG") || has(":TRIGger[:IMMediate]")) {
            return Err(Failure::UNDEFINED_HEADER);
        }
        let settings = &self.body.settings;
        let pulsed = ["PULSe", "SQUare"].contains(&settings.choice("shape"));
        let ready = settings.on("output") && settings.on("burst") && pulsed;
        if !ready || self.burst_end_us.is_some() {
            return Err(Failure::TRIGGER_IGNORED);
        }
        self.burst(at.now_us, at.circuit);
        Ok(Outcome::Done(self.body.command_us))
    }

    fn fetch(&mut self, _: &Unit) -> Result<Outcome, Failure> {
        Err(Failure::DATA_STALE)
    }

    fn next_us(&self) -> Option<u64> {
        self.burst_end_us
    }

    fn tick(&mut self, _: &mut Moment<'_>) {
        self.burst_end_us = None;
    }
}
