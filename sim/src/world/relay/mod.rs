//! A relay on the probes: coil, armature and two contacts, moved from event to event.
//!
//! Flux, armature and leaf move by the five-state model of [`lumped`], with the parameters that
//! [`fit`] finds for the specimen; [`motion`] holds the equilibrium while nothing moves. So lag of a
//! ramp, slowing near the threshold, flutter of a pulse that ends too early and the time of a clamp
//! are those of the equations. Two things are laid over them, because they scatter from closure to
//! closure in a way no lumped model tells: the bounce list of a first make, and the resistance of a
//! closure. Thresholds follow the copper's temperature and scatter from operation to operation: the
//! remanence differs, and a volt of remanence is a volt less at the coil.

mod contacts;
pub mod defect;
pub mod drawn;
pub mod fit;
pub mod golden;
mod lot;
pub mod lumped;
mod motion;
mod on_probes;
pub mod record;
pub mod table;
mod thermal;

use std::collections::VecDeque;

use super::draw::Draw;
use super::probes::{Change, Contact, Supply};
use super::specimen::REFERENCE_C;
use super::table::WorldTable;
use defect::Defect;
use drawn::Drawn;
pub use lot::Lot;
use lumped::{Drive, Model};
pub use motion::Levels;
use motion::Motion;
use record::Record;
use thermal::Thermal;

/// A relay whose coil and contacts somebody can touch.
#[derive(Debug, Clone)]
pub struct Relay {
    drawn: Drawn,
    motion: Motion,
    copper_zero_c: f64,
    scatter_v: f64,
    bounce_ln_sd: f64,
    ambient_c: f64,
    thermal: Thermal,
    draw: Draw,
    supply: Supply,
    since_us: f64,
    operation_v: f64,
    closed: [bool; 2],
    /// The contact that made last: the armature is on its side, or was.
    side: Contact,
    /// Until then the bounce list speaks for the contact that has made.
    settled_us: f64,
    bounce: VecDeque<Change>,
    /// What this relay has shown so far.
    pub record: Record,
}

/// Longest stretch over which the resistance is held still, microseconds.
const STILL_US: f64 = 50_000.0;
/// The bounce of a closure is over after so long, microseconds.
const SETTLING_US: f64 = 8_000.0;
/// A change of the supply by so much of nominal begins a new operation and ends any settling.
const NEW_OPERATION: f64 = 0.1;

impl Relay {
    /// Puts a drawn relay into the world at an instant; `draw` is the chance of its operations.
    pub fn new(
        mut drawn: Drawn,
        world: &WorldTable,
        mut draw: Draw,
        t_us: f64,
        track_c: f64,
        ambient_c: f64,
    ) -> Self {
        let table = &world.relay;
        let welded = drawn.defect == Some(Defect::StuckNo);
        let above = track_c + drawn.offset_k - ambient_c;
        let film = if welded { drawn.film_no } else { drawn.film_nc };
        let side = if welded { Contact::No } else { Contact::Nc };
        let mut record = Record::new(&drawn);
        record.close(side, film.close(&mut draw));
        let model = Model::new(&drawn.wanted(world).fit(&table.lumped));
        drawn.operate_v = model.pickup().volts;
        drawn.release_v = model.release().volts;
        let supply = Supply::Off {
            clamp_v: world.board.zener_v,
        };
        let stuck = drawn.coil_ohm.is_infinite()
            || matches!(drawn.defect, Some(Defect::StuckNo | Defect::StuckNc));
        let drive = Drive::Clamp {
            volts: world.board.zener_v,
        };
        let scatter_v = world.lot.threshold_scatter_sd_mv * 1e-3 * drawn.volt_scale;
        let mut relay = Self {
            motion: Motion::new(model, t_us * 1e-6, drive, stuck, welded),
            copper_zero_c: table.copper_zero_c,
            scatter_v,
            bounce_ln_sd: world.lot.bounce_ln_sd,
            ambient_c,
            thermal: Thermal::new(table, above),
            operation_v: draw.normal(0.0, scatter_v),
            draw,
            supply,
            since_us: t_us,
            closed: [welded, !welded],
            side,
            settled_us: t_us,
            bounce: VecDeque::new(),
            record,
            drawn,
        };
        relay.restart();
        relay
    }

    /// What it was drawn as; its thresholds are those that it moves with.
    pub fn drawn(&self) -> &Drawn {
        &self.drawn
    }

    /// Rig time that its armature was held, and moved.
    pub fn levels(&self) -> Levels {
        self.motion.levels()
    }

    /// Whether a contact is closed now.
    pub fn is_closed(&self, contact: Contact) -> bool {
        self.closed[contact as usize]
    }

    /// Coil resistance now, ohm.
    pub fn coil_ohm(&self) -> f64 {
        self.drawn.coil_ohm * self.copper_ratio()
    }

    /// Coil current now, ampere.
    pub fn coil_current_a(&self) -> f64 {
        match self.drawn.coil_ohm.is_infinite() {
            true => 0.0,
            false => self.motion.current(self.supply.volts()),
        }
    }

    /// Another supply from now on; the relay must have been advanced to `t_us`.
    pub fn drive(&mut self, t_us: f64, supply: Supply) {
        if supply == self.supply {
            return;
        }
        let (old, new) = (self.supply.volts(), supply.volts());
        self.settle(t_us);
        self.supply = supply;
        self.restart();
        if (new - old).abs() > NEW_OPERATION * self.drawn.nominal_v {
            self.settled_us = self.settled_us.min(t_us);
        }
        self.record
            .supply_step(t_us, old, new, self.motion.at_a_stop());
    }

    /// Goes on to `t_us`, or to the first change of a contact before it.
    pub fn advance(&mut self, t_us: f64) -> Option<Change> {
        loop {
            let due = self.bounce.front().map_or(f64::INFINITY, |c| c.t_us);
            let goal = t_us.min(due).min(self.since_us + STILL_US);
            let change = match self.motion.advance(goal * 1e-6) {
                Some(event) => self.touched(&event),
                None if due <= goal => self.bounced(),
                None if goal >= t_us => return self.synchronised(t_us),
                None => {
                    self.settle(goal);
                    self.restart();
                    None
                }
            };
            if change.is_some() {
                return change;
            }
        }
    }

    fn copper_ratio(&self) -> f64 {
        let above_zero = self.ambient_c + self.thermal.coil_k() - self.copper_zero_c;
        above_zero / (REFERENCE_C - self.copper_zero_c)
    }

    /// Heat up to `t_us`; the supply has been still since the last call.
    fn settle(&mut self, t_us: f64) {
        let volts = self.supply.volts();
        let seconds = (t_us - self.since_us) * 1e-6;
        self.thermal
            .advance(seconds, volts * volts / self.coil_ohm());
        self.since_us = t_us;
    }

    /// Supply and copper as they now are reach the motion.
    fn restart(&mut self) {
        let drive = match self.supply {
            Supply::Volts(_) if self.drawn.coil_ohm.is_infinite() => Drive::still(0.0),
            Supply::Volts(volts) => Drive::still(volts - self.operation_v),
            Supply::Off { clamp_v } => Drive::Clamp { volts: clamp_v },
        };
        let ohm = self.copper_ratio() * self.motion.reference_ohm();
        self.motion.set(drive, ohm);
    }
}

#[cfg(test)]
mod tests;
