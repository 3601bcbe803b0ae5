//! Digitizer with 12 bits and four DC-coupled channels, in two command dialects.

use std::collections::VecDeque;

use super::front_end::{CODES, FrontEnd, Range, VERTICAL};
use super::settings::{Changed, Kind, Setting};
use super::{Body, Channel, Instrument, Kit, Moment, Outcome};
use crate::scpi::circuit::Terminal;
use crate::scpi::message::{Unit, block, nr3};
use crate::scpi::status::Failure;

/// Number of channels.
pub(super) const CHANNELS: usize = 4;
/// Number of horizontal divisions of the screen; they span the record.
const HORIZONTAL: f64 = 10.0;
/// Time to send one byte of a block, microseconds.
const BYTE_US: f64 = 0.4;
/// Limit of error of the clock of the samples, as a fraction.
const CLOCK: f64 = 25e-6;
/// Time after which automatic triggering ends without a trigger event, microseconds.
const AUTO_US: u64 = 50_000;

/// Command set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Dialect {
    /// `:SING`, `:TRIG:STAT?`, `:WAV:STAR`; offset and reference both in steps.
    Rigol,
    /// `:DIG`, `:WAV:BYT`; origin in volts.
    Keysight,
}

pub(super) const RIGOL: Kit = Kit {
    identity: "RIGOL TECHNOLOGIES,DHO804,DHO8A250100001,00.01.03",
    latency_us: 1_500,
    command_us: 300,
    at: Terminal::Pulse,
    settings: TABLE,
};

pub(super) const KEYSIGHT: Kit = Kit {
    identity: "KEYSIGHT TECHNOLOGIES,DSOX1204G,CN60120001,02.12",
    ..RIGOL
};

use Kind::{Choice, Ignored, Number, Switch};
pub(super) const SOURCES: &[&str] = &["CHANnel1", "CHANnel2", "CHANnel3", "CHANnel4"];
#[rustfmt::skip]
const TABLE: &[Setting] = &[
    Setting("shown", ":CHANnel#:DISPlay", Switch(true), CHANNELS),
    Setting("scale", ":CHANnel#:SCALe", Number(5e-4, 1e3, 1.0), CHANNELS),
    Setting("range", ":CHANnel#:RANGe", Number(4e-3, 8e3, 8.0), CHANNELS),
    Setting("offset", ":CHANnel#:OFFSet", Number(-1e3, 1e3, 0.0), CHANNELS),
    Setting("probe", ":CHANnel#:PROBe", Number(1e-3, 1e4, 1.0), CHANNELS),
    Setting("coupling", ":CHANnel#:COUPling", Choice(&["DC"]), CHANNELS),
    Setting("inverted", ":CHANnel#:INVert", Switch(false), CHANNELS),
    Setting("bandwidth", ":CHANnel#:BWLimit", Ignored, CHANNELS),
    Setting("label", ":CHANnel#:LABel", Ignored, CHANNELS),
    Setting("time_scale", ":TIMebase[:MAIN]:SCALe", Number(1e-6, 10.0, 1e-3), 1),
    Setting("time_range", ":TIMebase[:MAIN]:RANGe", Number(1e-5, 100.0, 1e-2), 1),
    Setting("time_offset", ":TIMebase[:MAIN]:OFFSet", Number(-10.0, 10.0, 0.0), 1),
    Setting("position", ":TIMebase:POSition", Number(-10.0, 10.0, 0.0), 1),
    Setting("reference", ":TIMebase:REFerence", Choice(&["CENTer", "LEFT", "RIGHt"]), 1),
    Setting("time_mode", ":TIMebase:MODE", Choice(&["MAIN"]), 1),
    Setting("depth", ":ACQuire:MDEPth", Number(100.0, 1e6, 20_000.0), 1),
    Setting("acquire", ":ACQuire:TYPE", Choice(&["NORMal", "AVERage", "HRESolution", "PEAK"]), 1),
    Setting("acquire_mode", ":ACQuire:MODE", Choice(&["RTIMe"]), 1),
    Setting("trigger_mode", ":TRIGger:MODE", Choice(&["EDGE"]), 1),
    Setting("sweep", ":TRIGger:SWEep", Choice(&["AUTO", "NORMal", "SINGle"]), 1),
    Setting("trigger", ":TRIGger[:EDGE]:SOURce", Choice(SOURCES), 1),
    Setting("level", ":TRIGger[:EDGE]:LEVel", Number(-1e3, 1e3, 0.0), 1),
    Setting("slope", ":TRIGger[:EDGE]:SLOPe", Choice(&["POSitive", "NEGative"]), 1),
    Setting("source", ":WAVeform:SOURce", Choice(SOURCES), 1),
    Setting("mode", ":WAVeform:MODE", Choice(&["NORMal", "MAXimum", "RAW"]), 1),
    Setting("points_mode", ":WAVeform:POINts:MODE", Choice(&["NORMal", "MAXimum", "RAW"]), 1),
    Setting("format", ":WAVeform:FORMat", Choice(&["BYTE", "WORD", "ASCii"]), 1),
    Setting("order", ":WAVeform:BYTeorder", Choice(&["MSBFirst", "LSBFirst"]), 1),
    Setting("unsigned", ":WAVeform:UNSigned", Switch(true), 1),
    Setting("start", ":WAVeform:STARt", Number(1.0, 1e6, 1.0), 1),
    Setting("stop", ":WAVeform:STOP", Number(1.0, 1e6, 20_000.0), 1),
    Setting("points", ":WAVeform:POINts", Number(100.0, 1e6, 20_000.0), 1),
    Setting("header", ":SYSTem:HEADer", Ignored, 1),
    Setting("preset", ":SYSTem:PRESet", Ignored, 1),
];

/// An acquisition in progress.
struct Capture {
    next_us: u64,
    step_us: u64,
    /// Begin of the acquisition, the time from a sample to the next by the true clock, microseconds, and the samples so far.
    start_us: u64,
    true_step_us: f64,
    taken: u64,
    points: usize,
    before: usize,
    /// Samples of every channel, oldest first, as converter codes.
    samples: VecDeque<[u16; CHANNELS]>,
    /// Volts by which the trigger source exceeded the trigger level at the previous sample, positive in the direction
    /// of the slope.
    previous_v: Option<f64>,
    is_triggered: bool,
    /// Instant from which the acquisition triggers without an event; `None` when it always needs one.
    force_us: Option<u64>,
}

/// The digitizer with its acquisition and its memory.
pub(super) struct Digitizer {
    body: Body,
    channels: [Channel; CHANNELS],
    dialect: Dialect,
    front_end: FrontEnd,
    capture: Option<Capture>,
    memory: Vec<[u16; CHANNELS]>,
    /// Front end at the end of the record in memory.
    recorded: FrontEnd,
    step_us: u64,
    before: usize,
}

impl Digitizer {
    /// Creates a digitizer; a channel that `channels` lacks sees its default pair of terminals.
    pub(super) fn new(body: Body, channels: &[Channel], dialect: Dialect) -> Self {
        let spare = [
            Terminal::Pulse,
            Terminal::Output,
            Terminal::Clamped,
            Terminal::Load,
        ];
        let spare = spare.map(|at| Channel { at, ratio: 1.0 });
        let channels = std::array::from_fn(|n| *channels.get(n).unwrap_or(&spare[n]));
        let front_end = FrontEnd::new(&body.settings, &channels, dialect, &body.errors);
        Self {
            body,
            channels,
            dialect,
            front_end,
            capture: None,
            memory: Vec::new(),
            recorded: front_end,
            step_us: 1,
            before: 0,
        }
    }

    /// Starts an acquisition; with `auto` it also ends without a trigger event.
    fn start(&mut self, now_us: u64, auto: bool) {
        let points = self.body.settings.number("depth") as usize;
        let range_s = self.body.settings.number("time_scale") * HORIZONTAL;
        let step_us = (range_s * 1e6 / points as f64).round().max(1.0) as u64;
        let reference = match self.body.settings.choice("reference") {
            "LEFT" => 0.1,
            "RIGHt" => 0.9,
            _ => 0.5,
        };
        let offset = self.body.settings.number("time_offset") * 1e6 / step_us as f64;
        let before = (points as f64 * reference - offset).clamp(0.0, points as f64) as usize;
        let clock = 1.0 + CLOCK * self.body.errors.of_clock();
        self.capture = Some(Capture {
            next_us: now_us + step_us,
            step_us,
            start_us: now_us,
            true_step_us: step_us as f64 * clock,
            taken: 0,
            points,
            before,
            samples: VecDeque::with_capacity(points),
            previous_v: None,
            is_triggered: false,
            force_us: auto.then_some(now_us + AUTO_US),
        });
    }

    fn source(&self) -> usize {
        let source = self.body.settings.choice("source");
        let index = SOURCES.iter().position(|it| *it == source);
        index.unwrap_or_default()
    }

    /// Returns the range of the waveform source: that of the record, or of the settings before the first record.
    fn range(&self) -> &Range {
        let front_end = match self.memory.is_empty() {
            true => &self.front_end,
            false => &self.recorded,
        };
        &front_end.ranges[self.source()]
    }

    /// Returns the number of converter codes per step of the transferred data.
    fn coarse(&self) -> f64 {
        let is_byte = self.body.settings.choice("format") == "BYTE";
        match (is_byte, self.dialect) {
            (true, _) => 16.0,
            (false, Dialect::Rigol) => 1.0,
            // The codes occupy the upper bits of a word.
            (false, Dialect::Keysight) => 1.0 / 16.0,
        }
    }

    fn window(&self) -> std::ops::Range<usize> {
        let many = self.memory.len();
        let (from, to) = match self.dialect {
            Dialect::Rigol => (
                self.body.settings.number("start"),
                self.body.settings.number("stop"),
            ),
            Dialect::Keysight => (1.0, self.body.settings.number("points")),
        };
        let to = (to as usize).min(many);
        (from as usize - 1).min(to)..to
    }

    fn preamble(&self) -> String {
        let range = self.range();
        let step_v = range.full_v / CODES * self.coarse();
        let middle = CODES / 2.0 / self.coarse();
        let format = match (self.body.settings.choice("format"), self.dialect) {
            ("BYTE", _) => 0,
            ("WORD", _) => 1,
            (_, Dialect::Rigol) => 2,
            (_, Dialect::Keysight) => 4,
        };
        let kind = if self.dialect == Dialect::Rigol { 2 } else { 0 };
        let step_s = self.step_us as f64 * 1e-6;
        let origin_s = -(self.before as f64) * step_s;
        let (origin, reference) = match self.dialect {
            Dialect::Rigol => ((range.offset_v / step_v).round(), middle),
            Dialect::Keysight => (-range.offset_v, middle),
        };
        let numbers = [step_s, origin_s, step_v, origin];
        let [dx, x0, dy, y0] = numbers.map(nr3);
        let points = self.window().len();
        format!(
            "{format},{kind},{points},1,{dx},{x0},0,{dy},{y0},{}",
            reference as i64
        )
    }

    fn data(&self) -> Result<Outcome, Failure> {
        if self.memory.is_empty() {
            return Err(Failure::DATA_STALE);
        }
        let channel = self.source();
        let record = self.memory[self.window()].iter();
        let codes = record.map(|codes| codes[channel]);
        let coarse = self.coarse();
        let steps = codes.clone().map(|code| (f64::from(code) / coarse) as u16);
        let low_first =
            self.body.settings.choice("order") == "LSBFirst" || self.dialect == Dialect::Rigol;
        let bytes: Vec<u8> = match self.body.settings.choice("format") {
            "BYTE" => steps.map(|step| step as u8).collect(),
            "WORD" if low_first => steps.flat_map(u16::to_le_bytes).collect(),
            "WORD" => steps.flat_map(u16::to_be_bytes).collect(),
            _ => {
                let volts = codes.map(|code| nr3(self.range().volts(code)));
                volts.collect::<Vec<_>>().join(",").into_bytes()
            }
        };
        let busy_us = (bytes.len() as f64 * BYTE_US) as u64;
        let digits = if self.dialect == Dialect::Rigol { 9 } else { 8 };
        Ok(Outcome::Block(block(&bytes, digits), busy_us))
    }

    /// Updates the settings that state the changed quantity in another way: scale and range, position and offset.
    fn follow(&mut self, Changed { key, channel, .. }: Changed) {
        let settings = &mut self.body.settings;
        match key {
            "time_range" => {
                let scale = settings.number("time_range") / HORIZONTAL;
                settings.set("time_scale", scale);
            }
            "time_scale" => {
                let range = settings.number("time_scale") * HORIZONTAL;
                settings.set("time_range", range);
            }
            "position" => {
                let position = settings.number("position");
                settings.set("time_offset", position);
            }
            "range" => {
                let scale = settings.of("range", channel) / VERTICAL;
                settings.set_of("scale", channel, scale);
            }
            "scale" => {
                let range = settings.of("scale", channel) * VERTICAL;
                settings.set_of("range", channel, range);
            }
            "points" => {
                let points = settings.number("points");
                if self.memory.is_empty() {
                    settings.set("depth", points);
                }
            }
            _ => {}
        }
    }

    fn state(&self) -> &'static str {
        match &self.capture {
            Some(Capture {
                is_triggered: true, ..
            }) => "TD",
            Some(Capture {
                samples, before, ..
            }) if samples.len() < *before => "RUN",
            Some(_) => "WAIT",
            None => "STOP",
        }
    }
}

impl Instrument for Digitizer {
    fn body(&mut self) -> &mut Body {
        &mut self.body
    }

    fn reset(&mut self, _: &mut Moment<'_>) -> u64 {
        self.body.settings.reset();
        self.front_end = FrontEnd::new(
            &self.body.settings,
            &self.channels,
            self.dialect,
            &self.body.errors,
        );
        self.capture = None;
        self.memory.clear();
        400_000
    }

    fn changed(&mut self, changed: Changed, _: &mut Moment<'_>) -> Result<u64, Failure> {
        self.follow(changed);
        self.front_end = FrontEnd::new(
            &self.body.settings,
            &self.channels,
            self.dialect,
            &self.body.errors,
        );
        Ok(0)
    }

    fn perform(&mut self, unit: &Unit, at: &mut Moment<'_>) -> Result<Outcome, Failure> {
        let has = |pattern| unit.matches(pattern).is_some();
        let command_us = self.body.command_us;
        let text = |text: String| Ok(Outcome::Text(text, command_us));
        let done = Outcome::Done(command_us);
        let is_rigol = self.dialect == Dialect::Rigol;
        let is_auto = self.body.settings.choice("sweep") == "AUTO";
        match unit.query {
            true if has(":WAVeform:DATA") => self.data(),
            true if has(":WAVeform:PREamble") => text(self.preamble()),
            true if has(":TRIGger:STATus") && is_rigol => text(self.state().into()),
            true if has(":ACQuire:SRATe") => text(nr3(1e6 / self.step_us as f64)),
            true if has(":OPERegister:CONDition") && !is_rigol => {
                text(if self.capture.is_some() { "8" } else { "0" }.into())
            }
            true if has(":TER") && !is_rigol => {
                let waits = self.capture.as_ref().is_some_and(|it| !it.is_triggered);
                text(if waits { "0" } else { "1" }.into())
            }
            false if has(":SINGle") || has(":RUN") => {
                self.start(at.now_us, is_auto && has(":RUN"));
                Ok(done)
            }
            // No further command runs until the record is complete.
            false if has(":DIGitize") && !is_rigol => {
                self.start(at.now_us, is_auto);
                Ok(Outcome::AfterJob)
            }
            false if has(":TFORce") || has(":TRIGger:FORCe") => {
                let capture = self.capture.as_mut().ok_or(Failure::TRIGGER_IGNORED)?;
                capture.force_us = Some(at.now_us);
                Ok(done)
            }
            false if has(":STOP") => {
                self.capture = None;
                Ok(done)
            }
            false if has(":AUToscale") => Ok(Outcome::Done(1_000_000)),
            true | false => Err(Failure::UNDEFINED_HEADER),
        }
    }

    fn fetch(&mut self, _: &Unit) -> Result<Outcome, Failure> {
        Ok(Outcome::Done(0))
    }

    fn next_us(&self) -> Option<u64> {
        self.capture.as_ref().map(|capture| capture.next_us)
    }

    fn end_us(&self) -> Option<u64> {
        let capture = self.capture.as_ref()?;
        let taken = match capture.is_triggered {
            true => capture.samples.len(),
            false => capture.before,
        };
        let later = (capture.points - taken).saturating_sub(1) as u64;
        Some(capture.due_us(capture.taken + 1 + later))
    }

    fn tick(&mut self, at: &mut Moment<'_>) {
        let (codes, above_v) = self.front_end.convert(&mut self.body.errors, at.circuit);
        if let Some(capture) = &mut self.capture
            && capture.take(codes, above_v, at.now_us)
            && let Some(capture) = self.capture.take()
        {
            (self.step_us, self.before) = (capture.step_us, capture.before);
            self.recorded = self.front_end;
            self.memory = capture.samples.into();
            self.memory.truncate(capture.points);
        }
    }

    /// Takes samples in a row, because an event for each would cost more than the sample.
    fn run(&mut self, at: &mut Moment<'_>, end_us: u64) {
        self.tick(at);
        while let Some(next_us) = self.next_us().filter(|next_us| *next_us < end_us) {
            at.now_us = next_us.max(at.now_us);
            at.circuit.advance(at.now_us);
            self.tick(at);
        }
    }
}

impl Capture {
    /// Returns the instant of the sample with this number, from 1, microseconds.
    fn due_us(&self, number: u64) -> u64 {
        self.start_us + (number as f64 * self.true_step_us).round() as u64
    }

    /// Stores one sample; `above_v` is the height of the trigger source above the level, positive in the direction of
    /// the slope. Returns true when the record is complete.
    fn take(&mut self, codes: [u16; CHANNELS], above_v: f64, now_us: u64) -> bool {
        self.samples.push_back(codes);
        self.taken += 1;
        self.next_us = self.due_us(self.taken + 1);
        let was_below = self.previous_v.replace(above_v).is_some_and(|it| it < 0.0);
        let crossed = was_below && above_v >= 0.0;
        let forced = self.force_us.is_some_and(|force_us| force_us <= now_us);
        if !self.is_triggered && self.samples.len() > self.before {
            self.is_triggered = crossed || forced;
            if !self.is_triggered {
                self.samples.pop_front();
            }
        }
        self.is_triggered && self.samples.len() >= self.points
    }
}
