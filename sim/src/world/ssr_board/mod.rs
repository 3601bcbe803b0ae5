//! The interface board of a rig for solid-state relays: it connects instruments, short check, bleed and references to
//! the socket, and holds the interlocks that no program can bypass.
//!
//! The socket is one node with a capacitance. Voltages count from out1 to out2 at the pins; `output_polarity` reverses
//! the sources, not the probes of the digitizer. When its interlock opens, an output switches off at once, a contactor
//! after its release time. While a contactor is closed, the line feeds the socket; besides it only short check and
//! bleed are connected.

mod alternating;
mod circuit;
mod contactor;
mod network;
mod power;

use super::draw::Draw;
use super::fixture::Probes;
use super::signal::{Commands, In, Out};
use super::specimen::Specimen;
use super::ssr::Ssr;
use super::table::table;
use crate::scpi::circuit::{Drive, Reading};
use crate::scpi::line::Line;
use crate::scpi::sources::PulseInput;
use alternating::Alternating;
use power::Contactors;
pub use power::{MainsTable, Troubles};

table!(
    /// The interface board.
    FixtureTable {
        series_ohm: f64, bleed_ohm: f64, short_check_v: f64, short_check_ohm: f64,
        short_seen_ma: f64, reference_ohm: f64, reference_short_mohm: f64, resistor_error_pct: f64,
        insulation_gohm: f64, capacitance_nf: f64, contact_mohm: f64, kelvin_below_ohm: f64,
        safe_below_v: f64, safe_after_ms: f64, input_limit_v: f64,
        line_ohm: f64, line_henry: f64, line_shunt_ohm: f64, loop_ohm: f64, loop_shunt_mohm: f64,
        contactor_close_ms: f64, contactor_open_ms: f64, socket_short_mohm: f64,
        blown_gohm: f64,
    }
);

/// Interval at which the interlock of the jaws looks at the detector while it holds them, microseconds.
const LOOK_US: f64 = 100.0;
/// Least time to the next edge of the pulses or switching of the part, microseconds. Rounding would lose a shorter one,
/// and the clock would stand still.
const EDGE_US: f64 = 1e-3;

/// Output of the part, or the reference in its place.
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
    /// The AC source, its contactors, and the circuit of the one that is closed.
    line: Line,
    contactors: Contactors,
    alternating: Option<Box<Alternating>>,
    /// Last instant at which the detector saw a dangerous voltage, microseconds.
    unsafe_us: f64,
    /// Operating point of the input that was computed last, with its conditions.
    input: Option<(InputAt, Reading)>,
    /// Voltage over the socket, volts.
    socket_v: f64,
    now_us: f64,
}

impl SsrBoard {
    /// Creates a board with drawn resistors and discharged socket.
    pub fn new(table: &FixtureTable, mains: &MainsTable, draw: &mut Draw) -> Self {
        let mut table = table.clone();
        for ohms in [
            &mut table.series_ohm,
            &mut table.bleed_ohm,
            &mut table.short_check_ohm,
            &mut table.reference_ohm,
            &mut table.line_ohm,
            &mut table.loop_ohm,
        ] {
            *ohms *= 1.0 + draw.half(table.resistor_error_pct / 100.0);
        }
        let line_seed = draw.below(1 << 32);
        for shunt in [&mut table.line_shunt_ohm, &mut table.loop_shunt_mohm] {
            *shunt *= 1.0 + draw.half(table.resistor_error_pct / 100.0);
        }
        Self {
            line: Line::new(line_seed, mains.unrest()),
            contactors: Contactors::new(table.contactor_close_ms, table.contactor_open_ms),
            alternating: None,
            unsafe_us: f64::NEG_INFINITY,
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
            let until_us = self.contactors.due_us().clamp(self.now_us, t_us);
            match self.alternating.is_some() {
                true => self.step_alternating(until_us, part.as_deref_mut()),
                false => self.step(until_us, part.as_deref_mut().and_then(Specimen::as_ssr_mut)),
            }
            self.switch_contactors(part.as_deref_mut());
        }
    }

    /// Advances without a closed contactor to `t_us`, or only to the next switching if that comes first.
    fn step(&mut self, t_us: f64, part: Option<&mut Ssr>) {
        self.input = Some(self.input(part.as_deref()));
        let dt_us = self.step_us(part.as_deref()).min(t_us - self.now_us);
        self.detect(self.socket_v);
        self.pass(dt_us, part);
        let next_us = self.now_us + dt_us;
        // The last step ends exactly at `t_us`, whatever the rounding.
        self.now_us = if next_us < t_us { next_us } else { t_us };
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
        self.energise();
    }

    /// Sets the state of probes and door; the chain opens as soon as the block leaves its upper end.
    pub fn probe(&mut self, probes: Probes) {
        let touching = probes.touch && probes.stay;
        if touching && !self.touching {
            self.film_ohm += self.film_per_touch_ohm;
        }
        (self.chain, self.touching) = (probes.stay, touching);
        self.door_closed = probes.door_closed;
        self.energise();
    }

    /// Makes each further touch add this film to both probes of the input together.
    pub fn add_film_per_touch(&mut self, per_touch_ohm: f64) {
        self.film_per_touch_ohm = per_touch_ohm;
    }

    /// Returns the instant at which the interlock of the jaws looks next, microseconds; `None` while it holds nothing.
    pub fn next_us(&self) -> Option<f64> {
        let held = self.commands.is_on(Out::ClampOpen) && !self.frees_jaws();
        held.then_some(self.now_us + LOOK_US)
    }

    /// Returns the voltage of the socket at the analog input apart from the instruments, volts.
    pub fn residual_v(&self) -> f64 {
        match &self.alternating {
            Some(circuit) => circuit.at(self.now_us).volts,
            None => self.socket_v,
        }
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
            In::LineOpen => Some(self.contactors.open()[0]),
            In::LoopOpen => Some(self.contactors.open()[1]),
            In::OutputSafe => Some(self.frees_jaws()),
            In::ShortSeen => Some(self.short_check_a() > self.table.short_seen_ma * 1e-3),
            In::ProbeChain => Some(self.chain),
            _ => None,
        }
    }

    /// Checks whether an output of the socket is on and allowed.
    fn connects(&self, out: Out) -> bool {
        self.chain && self.commands.is_on(out)
    }

    fn short_check_a(&self) -> f64 {
        match self.connects(Out::ShortCheck) {
            true => {
                let across_v = self.table.short_check_v - self.sign() * self.residual_v();
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
        let edge_us = self.pulse.edge_us(self.now_us);
        let switch_us = part.and_then(|part| part.switch_us(self.goal(part)));
        let events = [edge_us, switch_us].into_iter().flatten();
        events.fold(f64::INFINITY, f64::min).max(EDGE_US)
    }

    /// Advances socket and part by a time in which nothing switches before its end.
    fn pass(&mut self, dt_us: f64, part: Option<&mut Ssr>) {
        let network = self.with_output(part.as_deref());
        self.socket_v = network.after(self.socket_v, self.at_socket(), dt_us * 1e-6);
        let Some(part) = part else {
            return;
        };
        let goal = self.goal(part);
        let watts = match self.meets_output(part) {
            true => self.socket_v * self.socket_v * part.siemens(),
            false => 0.0,
        };
        part.pass(dt_us, goal, watts);
    }
}
