//! The interface board of the rig, of whatever kind: what modules and instruments reach.
//!
//! This file lists the kinds, one variant for each; the kind of the parts in the magazine chooses.

use super::board::Board;
use super::board::supply::{CoilSupply, SupplyRange};
use super::draw::Draw;
use super::fault::Fault;
use super::signal::{Commands, In, Quantity, Source};
use super::specimen::Specimen;
use super::ssr_board::{SsrBoard, Troubles};
use super::table::{WorldTable, present};
use super::wiring::Wiring;
use crate::config::{ConfigError, Files, RigFile};
use crate::scpi::circuit::{Drive, Reading, Terminal};
use crate::truth::{ContactMove, Overdrive};

/// State of pin block and door.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Probes {
    /// The block is up.
    pub up: bool,
    /// The probes touch the pins of a clamped part.
    pub touch: bool,
    /// The block is up and not about to go down.
    pub stay: bool,
    /// The door is closed.
    pub door_closed: bool,
}

/// An interface board.
#[derive(Debug, Clone)]
pub enum Fixture {
    /// For relays with coil and contacts, and for dummies in their body.
    Relay(Box<Board>),
    /// For solid-state relays.
    Ssr(Box<SsrBoard>),
}

impl Fixture {
    /// Creates the board for the recipe in the magazine, with drawn errors.
    ///
    /// # Errors
    /// Fails when the recipe cannot be read, or the world has no table of this board.
    pub fn new(
        (files, recipe): (&Files, &str),
        rig: &RigFile,
        table: &WorldTable,
        wiring: &Wiring,
        draw: &mut Draw,
    ) -> Result<Self, ConfigError> {
        let kind: Option<String> = files.recipe(recipe)?.get("kind")?;
        if kind.as_deref() == Some("ssr") {
            let mains = present(&table.mains, "mains", files)?;
            let table = present(&table.fixture, "fixture", files)?;
            return Ok(Self::Ssr(Box::new(SsrBoard::new(&table, &mains, draw))));
        }
        let table = present(&table.board, "board", files)?;
        let supply = CoilSupply::new(&table, wiring, rig.supply_ranges.clone());
        let board = Board::new(&table, &rig.reference, supply, draw);
        Ok(Self::Relay(Box::new(board)))
    }

    /// Advances board and part to `t_us`.
    pub fn advance(&mut self, t_us: f64, part: Option<&mut Specimen>) {
        match self {
            Self::Relay(board) => board.advance(t_us, part),
            Self::Ssr(board) => board.advance(t_us, part),
        }
    }

    /// Sets the state of probes and door.
    pub fn probe(&mut self, probes: Probes, part: Option<&mut Specimen>) {
        match self {
            Self::Relay(board) => board.probe(probes.up, probes.touch, part),
            Self::Ssr(board) => board.probe(probes),
        }
    }

    /// Sets the faults of the board; `lasts` says which are present.
    pub fn trouble(&mut self, lasts: impl Fn(Fault) -> bool) {
        match self {
            Self::Relay(_) => {}
            Self::Ssr(board) => board.trouble(Troubles::of(lasts)),
        }
    }

    /// Applies all commands of the controller.
    pub fn command(&mut self, commands: Commands, part: Option<&mut Specimen>) {
        match self {
            Self::Relay(board) => board.command(commands, part),
            Self::Ssr(board) => board.command(commands),
        }
    }

    /// Checks whether the interlock lets the jaws open.
    pub fn frees_jaws(&self) -> bool {
        match self {
            Self::Relay(_) => true,
            Self::Ssr(board) => board.frees_jaws(),
        }
    }

    /// Returns the instant at which the interlock of the jaws checks next, microseconds; `None` while it holds nothing.
    pub fn next_us(&self) -> Option<u64> {
        match self {
            Self::Relay(_) => None,
            Self::Ssr(board) => board.next_us().map(|at_us| at_us.ceil() as u64),
        }
    }

    /// Returns a digital signal of the board; `None` for a signal of another source.
    pub fn signal(&self, signal: In, part: Option<&Specimen>) -> Option<bool> {
        match self {
            Self::Relay(board) => board.signal(signal, part),
            Self::Ssr(board) => board.signal(signal, part),
        }
    }

    /// Returns the volts that a quantity puts on the terminal of an analog input with this gain.
    pub fn analog_v(&self, quantity: Quantity, gain: f64, part: Option<&Specimen>) -> f64 {
        match (self, quantity) {
            (Self::Relay(board), _) => board.clip(board.quantity(quantity, part) * gain),
            (Self::Ssr(board), Quantity::ResidualVoltage) => board.clip(board.residual_v() * gain),
            (Self::Ssr(_), _) => f64::NAN,
        }
    }

    /// Sets the terminal of a source of the coil supply to `volts`.
    pub fn supply(&mut self, source: Source, volts: f64, part: Option<&mut Specimen>) {
        match self {
            Self::Relay(board) => board.supply(source, volts, part),
            Self::Ssr(_) => {}
        }
    }

    /// Returns the total open time of a gate, microseconds.
    pub fn gate_open_us(&self, gate: usize) -> f64 {
        match self {
            Self::Relay(board) => board.gate_open_us(gate),
            Self::Ssr(_) => 0.0,
        }
    }

    /// Shifts the ratio of the coil voltage divider by `per_mille` parts per thousand.
    pub fn drift(&mut self, per_mille: f64) {
        match self {
            Self::Relay(board) => board.drift(per_mille),
            Self::Ssr(_) => {}
        }
    }

    /// Makes each further touch add this film to both probes of the input together.
    pub fn add_film_per_touch(&mut self, per_touch_ohm: f64) {
        match self {
            Self::Relay(board) => board.add_film_per_touch(per_touch_ohm),
            Self::Ssr(board) => board.add_film_per_touch(per_touch_ohm),
        }
    }

    /// Makes the range relays of the coil supply stick in a range.
    pub fn stick(&mut self, range: SupplyRange) {
        match self {
            Self::Relay(board) => board.stick(range),
            Self::Ssr(_) => {}
        }
    }

    /// Returns every overdrive of a coil so far, in order of time.
    pub fn overdrives(&self) -> &[Overdrive] {
        match self {
            Self::Relay(board) => board.overdrives(),
            Self::Ssr(_) => &[],
        }
    }

    /// Returns every move of the main contacts of a contactor so far, in order of time.
    pub fn contact_moves(&self) -> &[ContactMove] {
        match self {
            Self::Relay(_) => &[],
            Self::Ssr(board) => board.contact_moves(),
        }
    }

    /// Returns the present phase of the line, 0 to 360 degrees; 0 without a line.
    pub fn line_deg(&self) -> f64 {
        match self {
            Self::Relay(_) => 0.0,
            Self::Ssr(board) => board.line_deg(),
        }
    }

    /// Connects a source of an instrument from the present instant on.
    pub fn drive(&mut self, terminal: Terminal, drive: Drive) {
        match self {
            Self::Relay(_) => {}
            Self::Ssr(board) => board.drive(terminal, drive),
        }
    }

    /// Returns the voltage and current that an instrument finds at a terminal.
    pub fn at(&self, terminal: Terminal, part: Option<&Specimen>) -> Reading {
        match self {
            Self::Relay(_) => Reading::default(),
            Self::Ssr(board) => board.at(terminal, part),
        }
    }
}
