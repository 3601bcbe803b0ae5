//! Contactors of the output circuit with their interlocks and feedback, the load of the line, and the detector of a
//! safe socket.

use super::SsrBoard;
use super::alternating::Load;
use super::contactor::{Contactor, Damage};
use super::table;
use crate::scpi::line::Unrest;
use crate::truth::ContactMove;
use crate::world::fault::Fault;
use crate::world::signal::Out;
use crate::world::specimen::Specimen;

table!(
    /// The AC source and its load circuits.
    MainsTable {
        amplitude_sd_pct: f64, frequency_sd_hz: f64, slow_s: f64,
        third_pct: f64, fifth_pct: f64, phase_sd_us: f64,
    }
);

impl MainsTable {
    /// Returns the deviations of the line from a sine.
    pub fn unrest(&self) -> Unrest {
        Unrest {
            amplitude: self.amplitude_sd_pct / 100.0,
            hz: self.frequency_sd_hz,
            slow_s: self.slow_s,
            harmonics: [self.third_pct / 100.0, self.fifth_pct / 100.0],
            jitter_us: self.phase_sd_us,
        }
    }
}

/// Faults of the output circuit.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Troubles {
    /// Damage of the line contactor and of the loop contactor.
    pub contactors: [Damage; 2],
    /// The mirror contacts stay as they are.
    pub mirrors_stuck: bool,
    /// A short over the output pins.
    pub socket_short: bool,
    /// The fuse between the AC source and the load of the line is blown; the loop has its own.
    pub line_dead: bool,
    /// The fuse between the AC source and the load of the loop is blown.
    pub loop_dead: bool,
    /// A lead between the source-measure unit and the output is broken.
    pub lead_open: bool,
}

impl Troubles {
    /// Returns the troubles by the faults that last at present.
    pub fn of(lasts: impl Fn(Fault) -> bool) -> Self {
        let damage = |welded: Fault, broken: Fault| Damage {
            welded: lasts(welded),
            broken: lasts(broken),
        };
        Self {
            contactors: [
                damage(Fault::LineWelded, Fault::LineBroken),
                damage(Fault::LoopWelded, Fault::LoopBroken),
            ],
            mirrors_stuck: lasts(Fault::MirrorsStuck),
            socket_short: lasts(Fault::SocketShort),
            line_dead: lasts(Fault::LineDead),
            loop_dead: lasts(Fault::LoopDead),
            lead_open: lasts(Fault::LeadOpen),
        }
    }
}

/// Index of the line contactor; the next number is that of the loop contactor.
const LINE: usize = 0;
const LOOP: usize = 1;
const OUTS: [Out; 2] = [Out::LineContactor, Out::LoopContactor];

/// Both contactors with their mirror contacts.
#[derive(Debug, Clone)]
pub struct Contactors {
    each: [Contactor; 2],
    /// Mirror contacts of both: true while the main contacts are open.
    open: [bool; 2],
    troubles: Troubles,
    /// Every move of main contacts so far.
    moves: Vec<ContactMove>,
}

impl Contactors {
    pub(super) fn new(close_ms: f64, open_ms: f64) -> Self {
        let new = || Contactor::new(close_ms * 1e3, open_ms * 1e3);
        Self {
            each: [new(), new()],
            open: [true; 2],
            troubles: Troubles::default(),
            moves: Vec::new(),
        }
    }

    /// Returns the instant at which main contacts move next, microseconds; infinite without one.
    pub(super) fn due_us(&self) -> f64 {
        self.each[LINE].due_us().min(self.each[LOOP].due_us())
    }

    /// Returns for line and loop contactor what its mirror contact says: true for open.
    pub(super) fn open(&self) -> [bool; 2] {
        self.open
    }

    fn show(&mut self) {
        if !self.troubles.mirrors_stuck {
            self.open = [LINE, LOOP].map(|place| !self.each[place].is_closed());
        }
    }
}

impl SsrBoard {
    /// Sets the faults of the output circuit.
    pub fn trouble(&mut self, troubles: Troubles) {
        if self.contactors.troubles == troubles {
            return;
        }
        self.contactors.troubles = troubles;
        for (contactor, damage) in self.contactors.each.iter_mut().zip(troubles.contactors) {
            contactor.damage(damage, self.now_us);
        }
        self.contactors.show();
        if let (Some(load), Some(circuit)) = (self.load(), &mut self.alternating) {
            circuit.reload(load);
        }
        self.energise();
    }

    /// Checks whether a fault keeps the source-measure unit from the output.
    pub(super) fn is_lead_open(&self) -> bool {
        self.contactors.troubles.lead_open
    }

    /// Checks whether a fault shorts the output pins.
    pub(super) fn is_shorted(&self) -> bool {
        self.contactors.troubles.socket_short
    }

    /// Switches the coils by commands and interlocks. A coil needs probes and door, and the other contactor uncommanded
    /// and open.
    pub(super) fn energise(&mut self) {
        let allowed = self.chain && self.door_closed;
        for (own, other) in [(LINE, LOOP), (LOOP, LINE)] {
            let alone =
                !self.commands.is_on(OUTS[other]) && !self.contactors.each[other].is_closed();
            let coil = allowed && alone && self.commands.is_on(OUTS[own]);
            self.contactors.each[own].energise(coil, self.now_us);
        }
        self.touch();
    }

    /// Makes the circuit of the line start a new segment, because something connected to it has changed.
    pub(super) fn touch(&mut self) {
        if let Some(circuit) = &mut self.alternating {
            circuit.touch(self.now_us);
        }
    }

    /// Moves the main contacts that are due.
    pub(super) fn switch_contactors(&mut self, mut part: Option<&mut Specimen>) {
        let now_us = self.now_us;
        let moved = [LINE, LOOP].map(|place| self.contactors.each[place].expire(now_us));
        if moved == [false; 2] {
            return;
        }
        for place in [LINE, LOOP].into_iter().filter(|place| moved[*place]) {
            self.contactors.moves.push(ContactMove {
                t_us: now_us as u64,
                contactor: OUTS[place].name(),
                closed: self.contactors.each[place].is_closed(),
            });
        }
        self.contactors.show();
        if let Some(mut circuit) = self.alternating.take() {
            self.settle(
                &mut circuit,
                part.as_deref_mut().and_then(Specimen::as_ssr_mut),
            );
        }
        if let Some(load) = self.load() {
            self.begin_alternating(load, part.as_deref().and_then(Specimen::as_ssr));
        }
        self.energise();
    }

    /// Returns the load that the closed contactor connects: of the line, or of the loop with its lower resistance;
    /// `None` while both are open.
    fn load(&self) -> Option<Load> {
        let table = &self.table;
        let [line, own_loop] = [LINE, LOOP].map(|place| self.contactors.each[place].is_closed());
        let fused = |ohms: f64, is_blown: bool| match is_blown {
            true => ohms + table.blown_gohm * 1e9,
            false => ohms,
        };
        let troubles = &self.contactors.troubles;
        match (line, own_loop) {
            (_, true) => Some(Load {
                ohms: fused(table.loop_ohm, troubles.loop_dead),
                henries: 0.0,
                shunt_ohm: table.loop_shunt_mohm * 1e-3,
            }),
            (true, false) => Some(Load {
                ohms: fused(table.line_ohm, troubles.line_dead),
                henries: match self.commands.is_on(Out::LoadSelect) {
                    true => table.line_henry,
                    false => 0.0,
                },
                shunt_ohm: table.line_shunt_ohm,
            }),
            (false, false) => None,
        }
    }

    /// Returns the shunt of the load current, ohms.
    pub(super) fn shunt_ohm(&self) -> f64 {
        let circuit = self.alternating.as_ref();
        circuit.map_or(self.table.line_shunt_ohm, |it| it.load().shunt_ohm)
    }

    /// Returns every move of the main contacts so far, in order of time.
    pub fn contact_moves(&self) -> &[ContactMove] {
        &self.contactors.moves
    }

    /// Gives a voltage at the socket to the detector.
    pub(super) fn detect(&mut self, volts: f64) {
        if volts.abs() >= self.table.safe_below_v {
            self.unsafe_us = self.now_us;
        }
    }

    /// Checks whether the interlock releases the jaws: the voltage at the socket has stayed below 30 V for a half
    /// cycle.
    pub fn frees_jaws(&self) -> bool {
        let peak_v = match &self.alternating {
            Some(circuit) => circuit.peak_v(self.now_us),
            None => self.socket_v.abs(),
        };
        let waits_us = self.table.safe_after_ms * 1e3;
        peak_v < self.table.safe_below_v && self.now_us >= self.unsafe_us + waits_us
    }
}
