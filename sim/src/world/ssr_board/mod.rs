//! The interface board of a rig for solid-state relays: what connects instruments, short check, bleed and references to
//! the socket, and the interlocks that no program can pass.
//!
//! The socket is one node with a capacitance. Voltages count from out1 to out2 at the pins; `output_polarity` reverses
//! the sources, not the probes of the digitizer. An output pulls off at once when its interlock opens.

mod circuit;
mod network;

use super::draw::Draw;
use super::fixture::Probes;
use super::signal::{Commands, In, Out};
use super::specimen::Specimen;
use super::ssr::Ssr;
use super::table::table;
use crate::scpi::circuit::{Drive, Reading};
use crate::scpi::sources::PulseInput;

table!(
    /// The interface board.
    FixtureTable {
        series_ohm: f64, bleed_ohm: f64, short_check_v: f64, short_check_ohm: f64,
        short_seen_ma: f64, reference_ohm: f64, reference_short_mohm: f64, resistor_error_pct: f64,
        insulation_gohm: f64, capacitance_nf: f64, contact_mohm: f64, kelvin_below_ohm: f64,
        safe_below_v: f64, input_limit_v: f64,
    }
);

/// Interval at which the interlock of the jaws looks at the detector while it holds them, microseconds.
const LOOK_US: f64 = 100.0;
/// Least time to the next edge of the pulses, microseconds.
const EDGE_US: f64 = 1e-3;

/// What stands in place of the output of the part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Reference {
    Part,
    Open,
    Short,
    Resistor,
}

/// Conditions of an operating point of the input: the source, and the temperature of a connected part.
#[derive(Debug, Clone, Copy, PartialEq)]
struct InputAt {
    drive: Drive,
    celsius: Option<f64>,
}

/// The interface board.
#[derive(Debug, Clone)]
pub struct SsrBoard {
    table: FixtureTable,
    commands: Commands,
    chain: bool,
    touching: bool,
    door_closed: bool,
    reference: Reference,
    /// Film on both probes of the input together, ohm; the next field is its growth per touch.
    film_ohm: f64,
    film_per_touch_ohm: f64,
    /// Sources of the units at input and output, and of the pulse source.
    smu_in: Drive,
    smu_out: Drive,
    pulse: PulseInput,
    /// Operating point of the input that was computed last, with its conditions.
    input: Option<(InputAt, Reading)>,
    /// Voltage over the socket, volts.
    socket_v: f64,
    now_us: f64,
}

impl SsrBoard {
    /// Creates a board with drawn resistors and discharged socket.
    pub fn new(table: &FixtureTable, draw: &mut Draw) -> Self {
        let mut table = table.clone();
        for ohms in [
            &mut table.series_ohm,
            &mut table.bleed_ohm,
            &mut table.short_check_ohm,
            &mut table.reference_ohm,
        ] {
            *ohms *= 1.0 + draw.half(table.resistor_error_pct / 100.0);
        }
        Self {
            table,
            commands: Commands::default(),
            chain: false,
            touching: false,
            door_closed: false,
            reference: Reference::Part,
            film_ohm: 0.0,
            film_per_touch_ohm: 0.0,
            smu_in: Drive::Open,
            smu_out: Drive::Open,
            pulse: PulseInput::default(),
            input: None,
            socket_v: 0.0,
            now_us: 0.0,
        }
    }

    /// Advances board and part to `t_us`.
    pub fn advance(&mut self, t_us: f64, mut part: Option<&mut Specimen>) {
        while self.now_us < t_us {
            let part = part.as_deref_mut().and_then(Specimen::as_ssr_mut);
            self.input = Some(self.input(part.as_deref()));
            let dt_us = self.step_us(part.as_deref()).min(t_us - self.now_us);
            self.pass(dt_us, part);
            let next_us = self.now_us + dt_us;
            // The last step ends at the instant itself, whatever the rounding.
            self.now_us = if next_us < t_us { next_us } else { t_us };
        }
    }

    /// Applies all commands of the controller.
    pub fn command(&mut self, commands: Commands) {
        self.commands = commands;
        let free = !self.commands.is_on(Out::SmuToOutput)
            && !self.commands.is_on(Out::LineContactor)
            && !self.commands.is_on(Out::LoopContactor);
        if free {
            let [low, high] = [Out::Reference0, Out::Reference1].map(|out| commands.is_on(out));
            self.reference = match (high, low) {
                (false, false) => Reference::Part,
                (false, true) => Reference::Open,
                (true, false) => Reference::Short,
                (true, true) => Reference::Resistor,
            };
        }
    }

    /// Sets the state of probes and door; the chain opens as soon as the block leaves its upper end.
    pub fn probe(&mut self, probes: Probes) {
        let touching = probes.touch && probes.stay;
        if touching && !self.touching {
            self.film_ohm += self.film_per_touch_ohm;
        }
        (self.chain, self.touching) = (probes.stay, touching);
        self.door_closed = probes.door_closed;
    }

    /// Makes each further touch add this film to both probes of the input together.
    pub fn add_film_per_touch(&mut self, per_touch_ohm: f64) {
        self.film_per_touch_ohm = per_touch_ohm;
    }

    /// Checks whether the interlock lets the jaws open: the detector sees less than 30 V.
    pub fn frees_jaws(&self) -> bool {
        self.socket_v.abs() < self.table.safe_below_v
    }

    /// Returns the instant at which the interlock of the jaws looks next, microseconds; `None` while it holds nothing.
    pub fn next_us(&self) -> Option<f64> {
        let held = self.commands.is_on(Out::ClampOpen) && !self.frees_jaws();
        held.then_some(self.now_us + LOOK_US)
    }

    /// Returns the voltage of the socket at the analog input apart from the instruments, volts.
    pub fn residual_v(&self) -> f64 {
        self.socket_v
    }

    /// Clips a voltage to the range of an analog input.
    pub fn clip(&self, volts: f64) -> f64 {
        volts.clamp(-self.table.input_limit_v, self.table.input_limit_v)
    }

    /// Returns a digital signal of the board; `None` for a signal of another source.
    pub fn signal(&self, signal: In, part: Option<&Specimen>) -> Option<bool> {
        let kelvin = |pin: usize| {
            let film_ohm = if pin < 2 { self.film_ohm / 2.0 } else { 0.0 };
            let probe_ohm = film_ohm + self.table.contact_mohm * 1e-3;
            let clean = probe_ohm < self.table.kelvin_below_ohm;
            let good = clean && part.is_some_and(|it| it.pins().kelvin[pin]);
            Some(self.commands.is_on(Out::KelvinTest) && self.touching && good)
        };
        match signal {
            In::KelvinInPlus => kelvin(0),
            In::KelvinInMinus => kelvin(1),
            In::KelvinOut1 => kelvin(2),
            In::KelvinOut2 => kelvin(3),
            In::LineOpen => Some(!self.closes(Out::LineContactor, Out::LoopContactor)),
            In::LoopOpen => Some(!self.closes(Out::LoopContactor, Out::LineContactor)),
            In::OutputSafe => Some(self.frees_jaws()),
            In::ShortSeen => Some(self.short_check_a() > self.table.short_seen_ma * 1e-3),
            In::ProbeChain => Some(self.chain),
            _ => None,
        }
    }

    /// Checks whether a contactor closes: the two exclude each other, and need probes and door.
    fn closes(&self, own: Out, other: Out) -> bool {
        self.chain && self.door_closed && self.commands.is_on(own) && !self.commands.is_on(other)
    }

    /// Checks whether an output of the socket is on and allowed.
    fn connects(&self, out: Out) -> bool {
        self.chain && self.commands.is_on(out)
    }

    fn short_check_a(&self) -> f64 {
        match self.connects(Out::ShortCheck) {
            true => {
                let across_v = self.table.short_check_v - self.sign() * self.socket_v;
                across_v / self.table.short_check_ohm
            }
            false => 0.0,
        }
    }

    /// Returns the sign of the sources at the pins.
    fn sign(&self) -> f64 {
        match self.commands.is_on(Out::OutputPolarity) {
            true => -1.0,
            false => 1.0,
        }
    }

    /// Returns the longest step in which nothing switches, microseconds.
    fn step_us(&self, part: Option<&Ssr>) -> f64 {
        let edge_us = self.pulse.edge_us(self.now_us).map(|it| it.max(EDGE_US));
        let switch_us = part.and_then(|part| part.switch_us(self.goal(part)));
        let events = [edge_us, switch_us].into_iter().flatten();
        events.fold(f64::INFINITY, f64::min)
    }

    /// Advances socket and part by a time in which nothing switches before its end.
    fn pass(&mut self, dt_us: f64, part: Option<&mut Ssr>) {
        let network = self.network(part.as_deref());
        self.socket_v = network.after(self.socket_v, self.at_socket(), dt_us * 1e-6);
        let Some(part) = part else {
            return;
        };
        let goal = self.goal(part);
        let watts = match self.meets_output(part) {
            true => self.socket_v * self.socket_v * part.siemens(),
            false => 0.0,
        };
        let (was_lit, switch_us) = (part.is_lit(), part.switch_us(goal));
        part.pass(dt_us, goal, watts);
        if switch_us.is_some_and(|it| it <= dt_us) {
            part.switch(!was_lit);
        }
    }
}
