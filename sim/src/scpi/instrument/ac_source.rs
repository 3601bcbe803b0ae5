//! AC source of the 61500 class. It switches its output off when the rms current stays above the limit for longer than
//! the delay; it refuses other shapes, couplings and modes.

use super::errors::Accuracy;
use super::settings::{Changed, Kind, Setting};
use super::window::Window;
use super::{Body, Instrument, Kit, Moment, Outcome};
use crate::scpi::circuit::{Circuit, Drive, Terminal};
use crate::scpi::message::{Unit, nr3};
use crate::scpi::status::Failure;

/// Time of `*RST`, microseconds.
const RESET_US: u64 = 7_000_000;
/// Length of a measurement in cycles; the next constant is its number of samples.
const CYCLES: f64 = 5.0;
const SAMPLES: u32 = 500;
/// Interval at which the source checks its current, microseconds; the next number is how many intervals make one rms.
const WATCH_US: u64 = 1_250;
const WATCHED: usize = 16;
/// Bit of the questionable status: the current limit has switched the output off.
const OVERCURRENT: u8 = 2;
/// Highest voltage of the lower range, volts rms.
const LOW_V: f64 = 150.0;

pub(super) const KIT: Kit = Kit {
    identity: "Chroma ATE,61503,61503A001234,1.50",
    latency_us: 15_000,
    command_us: 5_000,
    at: Terminal::Line,
    settings: TABLE,
};

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
    Setting("shape", "[:SOURce]:FUNCtion:SHAPe", Choice(&["A"]), 1),
    Setting("output", ":OUTPut[:STATe]", Switch(false), 1),
    Setting("coupling", ":OUTPut:COUPling", Choice(&["AC"]), 1),
    Setting("mode", ":OUTPut:MODE", Choice(&["FIXed"]), 1),
];

/// The source with its output and the measurement in progress.
pub(super) struct AcSource {
    body: Body,
    job: Option<Window>,
    last: Option<Window>,
    /// Instant at which the output switches off after the command to do so: when the voltage reaches the programmed
    /// phase, microseconds.
    off_us: Option<u64>,
    /// Instant of the next check of the current while the output is on; the next field holds the squares of the last
    /// currents.
    watch_us: Option<u64>,
    squares: [f64; WATCHED],
    looks: usize,
    /// Instant since which the current exceeds its limit.
    over_us: Option<u64>,
    tripped: bool,
}

impl AcSource {
    pub(super) fn new(body: Body) -> Self {
        Self {
            body,
            job: None,
            last: None,
            off_us: None,
            watch_us: None,
            squares: [0.0; WATCHED],
            looks: 0,
            over_us: None,
            tripped: false,
        }
    }

    /// Starts to watch the current when the output goes on; stops when it goes off.
    fn watch_output(&mut self, now_us: u64) {
        let is_on = self.body.settings.on("output") || self.off_us.is_some();
        self.watch_us = is_on.then_some(self.watch_us.unwrap_or(now_us + WATCH_US));
        if !is_on {
            (self.squares, self.over_us) = ([0.0; WATCHED], None);
        }
    }

    /// Checks whether the rms current has exceeded its limit for longer than the delay.
    fn is_over(&mut self, amps: f64, now_us: u64) -> bool {
        self.squares[self.looks % WATCHED] = amps * amps;
        self.looks += 1;
        let mean: f64 = self.squares.iter().sum::<f64>() / WATCHED as f64;
        if mean.sqrt() <= self.body.settings.number("limit_a") {
            self.over_us = None;
            return false;
        }
        let since_us = *self.over_us.get_or_insert(now_us);
        let delay_us = self.body.settings.number("limit_delay_s") * 1e6;
        (now_us - since_us) as f64 >= delay_us
    }

    /// Connects the output; with `starts` the sine begins at the programmed phase, otherwise it continues.
    fn drive(&mut self, circuit: &mut dyn Circuit, starts: bool) {
        let settings = &self.body.settings;
        if !settings.on("output") {
            circuit.drive(self.body.at, Drive::Open);
            return;
        }
        let accuracy = Accuracy {
            gain: 2e-3,
            offset: 0.3,
            noise: 0.0,
        };
        let (hz, phase_on) = (settings.number("hz"), settings.number("phase_on"));
        let rms_v = match settings.number("volts") {
            0.0 => 0.0,
            volts => self.body.errors.apply(0, accuracy, volts).max(0.0),
        };
        let phase_deg = starts.then_some(phase_on);
        let drive = Drive::Sine {
            rms_v,
            hz,
            phase_deg,
        };
        circuit.drive(self.body.at, drive);
    }

    /// Returns the instant at which the output reaches its switch-off phase; 360 degrees mean at once.
    fn off_at(&self, now_us: u64, circuit: &dyn Circuit) -> u64 {
        let phase_off = self.body.settings.number("phase_off");
        if phase_off >= 360.0 {
            return now_us;
        }
        let left_deg = (phase_off - circuit.line_deg()).rem_euclid(360.0);
        now_us + (left_deg / (360e-6 * self.body.settings.number("hz"))) as u64
    }

    /// Checks whether voltage and frequency are within the present limits.
    fn is_allowed(&self) -> bool {
        let settings = &self.body.settings;
        let most_v = match settings.choice("volt_range") {
            "LOW" => settings.number("limit_v").min(LOW_V),
            _ => settings.number("limit_v"),
        };
        settings.number("volts") <= most_v && settings.number("hz") <= settings.number("hz_limit")
    }
}

impl Instrument for AcSource {
    fn body(&mut self) -> &mut Body {
        &mut self.body
    }

    fn reset(&mut self, at: &mut Moment<'_>) -> u64 {
        self.body.settings.reset();
        (self.job, self.last, self.off_us) = (None, None, None);
        self.tripped = false;
        self.watch_output(at.now_us);
        self.drive(at.circuit, false);
        RESET_US
    }

    fn changed(&mut self, changed: Changed, at: &mut Moment<'_>) -> Result<u64, Failure> {
        if !self.is_allowed() {
            self.body.settings.set(changed.key, changed.before);
            return Err(Failure::OUT_OF_RANGE);
        }
        match (changed.key, changed.before != 0.0) {
            ("output", true) if !self.body.settings.on("output") => {
                self.off_us = Some(self.off_at(at.now_us, at.circuit));
            }
            ("output", was_on) => {
                (self.off_us, self.tripped) = (None, false);
                self.drive(at.circuit, !was_on);
            }
            ("volts" | "hz", _) if self.off_us.is_none() => self.drive(at.circuit, false),
            _ => {}
        }
        self.watch_output(at.now_us);
        Ok(0)
    }

    fn watch_us(&self) -> Option<u64> {
        self.watch_us
    }

    fn watch(&mut self, at: &mut Moment<'_>) -> Option<Failure> {
        self.watch_us = Some(at.now_us + WATCH_US);
        let amps = at.circuit.at(self.body.at).amps;
        if !self.is_over(amps, at.now_us) {
            return None;
        }
        self.body.settings.set("output", 0.0);
        (self.off_us, self.tripped) = (None, true);
        self.drive(at.circuit, false);
        self.watch_output(at.now_us);
        Some(Failure::OVERCURRENT)
    }

    fn perform(&mut self, unit: &Unit, at: &mut Moment<'_>) -> Result<Outcome, Failure> {
        let has = |pattern| unit.matches(pattern).is_some();
        let command_us = self.body.command_us;
        match unit.query {
            true if measured(unit, ":MEASure").is_some() => {
                let window_us = CYCLES * 1e6 / self.body.settings.number("hz");
                self.job = Some(Window::open(at.now_us, window_us, SAMPLES));
                Ok(Outcome::AfterJob)
            }
            true if measured(unit, ":FETCh").is_some() => self.fetch(unit),
            true if has(":STATus:QUEStionable:CONDition") => {
                let bits = if self.tripped { OVERCURRENT } else { 0 };
                Ok(Outcome::Text(bits.to_string(), command_us))
            }
            false if has(":ABORt") => {
                self.job = None;
                Ok(Outcome::Done(command_us))
            }
            true | false => Err(Failure::UNDEFINED_HEADER),
        }
    }

    fn fetch(&mut self, unit: &Unit) -> Result<Outcome, Failure> {
        let what = measured(unit, ":MEASure").or_else(|| measured(unit, ":FETCh"));
        let window = self.last.ok_or(Failure::DATA_STALE)?;
        let accuracy = |offset| Accuracy {
            gain: 2e-3,
            offset,
            noise: 0.02 * offset,
        };
        let (rms, errors) = (window.rms(), &mut self.body.errors);
        let value = match what.ok_or(Failure::UNDEFINED_HEADER)? {
            Measured::Volts => errors.apply_rms(1, accuracy(0.6), rms.volts),
            Measured::Amps => errors.apply_rms(2, accuracy(0.02), rms.amps),
            Measured::Watts => errors.apply(3, accuracy(1.0), window.power_w()),
            Measured::Hertz if self.body.settings.on("output") => self.body.settings.number("hz"),
            Measured::Hertz => 0.0,
        };
        Ok(Outcome::Text(nr3(value), 0))
    }

    fn next_us(&self) -> Option<u64> {
        let sample = self.job.map(|window| window.next_us());
        [sample, self.off_us].into_iter().flatten().min()
    }

    fn end_us(&self) -> Option<u64> {
        Some(self.job?.end_us())
    }

    fn tick(&mut self, at: &mut Moment<'_>) {
        if self.off_us.is_some_and(|off_us| off_us <= at.now_us) {
            self.off_us = None;
            self.drive(at.circuit, false);
            self.watch_output(at.now_us);
            return;
        }
        if let Some(window) = &mut self.job
            && window.take(at.circuit.at(self.body.at))
        {
            self.last = self.job.take();
        }
    }
}

#[derive(Clone, Copy)]
enum Measured {
    Volts,
    Amps,
    Watts,
    Hertz,
}

/// Returns the quantity of a query that begins with `verb`.
fn measured(unit: &Unit, verb: &str) -> Option<Measured> {
    let all = [
        ("VOLTage[:AC]", Measured::Volts),
        ("CURRent[:AC]", Measured::Amps),
        ("POWer[:AC][:REAL]", Measured::Watts),
        ("FREQuency", Measured::Hertz),
    ];
    let asked = |(quantity, _): &(&str, _)| {
        let pattern = format!("{verb}[:SCALar]:{quantity}");
        unit.matches(&pattern).is_some()
    };
    all.into_iter().find(asked).map(|(_, what)| what)
}
