//! A relay on the probes: coil, armature and two contacts, moved from event to event.
//!
//! The five-state model of [`lumped`] moves flux, armature and leaf, with the parameters that [`fit`] finds for the
//! specimen; [`motion`] holds the equilibrium while nothing moves. The equations therefore determine the overshoot of a
//! ramp, the slowing near the threshold, the flutter after a short pulse and the effect of the suppression. Two
//! properties that scatter between closures and that no lumped model gives are drawn instead: the bounce list of a
//! first make, and the resistance of a closure. Thresholds follow the temperature of the copper. They also scatter
//! between operations, because the remanence differs: a remanence of one volt reduces the effective coil voltage by one
//! volt.

pub mod certificate;
mod contacts;
pub mod defect;
pub mod fit;
mod lot;
pub mod lumped;
mod motion;
mod probe_interface;
pub mod record;
pub mod table;
mod thermal;
pub mod values;

use std::collections::VecDeque;

use super::draw::Draw;
use super::probes::{Change, Contact, Supply};
use super::specimen::REFERENCE_C;
use super::table::RelayWorld;
use defect::Defect;
pub use lot::Lot;
use lumped::{Drive, Model};
pub use motion::Levels;
use motion::Motion;
use record::RelayRecord;
use thermal::Thermal;
use values::RelayValues;

/// A relay with accessible coil and contacts.
#[derive(Debug, Clone)]
pub struct Relay {
    drawn: RelayValues,
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
    /// The contact that made last; the armature is on its side, or left it without making the other contact.
    side: Contact,
    /// End of the bounce of the present closure, microseconds.
    settled_us: f64,
    bounce: VecDeque<Change>,
    /// Results that this relay has shown so far: times, bounce, resistances.
    pub record: RelayRecord,
}

/// Longest interval over which the coil resistance counts as constant, microseconds.
const STILL_US: f64 = 50_000.0;
/// Time that the bounce of a closure lasts at most, microseconds.
const SETTLING_US: f64 = 8_000.0;
/// Change of the supply, relative to nominal, that starts a new operation and ends the settling.
const NEW_OPERATION: f64 = 0.1;

impl Relay {
    /// Creates a relay with the given true values at `t_us`; `draw` is the random stream of its operations.
    pub fn new(
        mut drawn: RelayValues,
        world: &RelayWorld,
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
        let mut record = RelayRecord::new(&drawn);
        record.close(side, film.close(&mut draw));
        let model = Model::new(&drawn.fit_target(world).fit(&table.lumped));
        drawn.operate_v = model.pickup().volts;
        drawn.release_v = model.release().volts;
        let supply = Supply::Off {
            suppression_v: world.board.zener_v,
        };
        let stuck = drawn.coil_ohm.is_infinite()
            || matches!(drawn.defect, Some(Defect::StuckNo | Defect::StuckNc));
        let drive = Drive::Suppression {
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

    /// Returns the true values, with the thresholds of the fitted model.
    pub fn values(&self) -> &RelayValues {
        &self.drawn
    }

    /// Returns the rig time spent at each level of detail of the motion: held and moving.
    pub fn levels(&self) -> Levels {
        self.motion.levels()
    }

    /// Checks whether a contact is closed now.
    pub fn is_closed(&self, contact: Contact) -> bool {
        self.closed[contact as usize]
    }

    /// Returns the present coil resistance, ohm.
    pub fn coil_ohm(&self) -> f64 {
        self.drawn.coil_ohm * self.copper_ratio()
    }

    /// Returns the present coil current, ampere.
    pub fn coil_current_a(&self) -> f64 {
        match self.drawn.coil_ohm.is_infinite() {
            true => 0.0,
            false => self.motion.current(self.supply.volts()),
        }
    }

    /// Changes the supply; the relay must already be at `t_us`.
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

    /// Advances to `t_us`, or to the first change of a contact before it.
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

    /// Advances the coil temperature to `t_us`; the supply must have been constant since the last call.
    fn settle(&mut self, t_us: f64) {
        let volts = self.supply.volts();
        let seconds = (t_us - self.since_us) * 1e-6;
        self.thermal
            .advance(seconds, volts * volts / self.coil_ohm());
        self.since_us = t_us;
    }

    /// Restarts the motion with the present supply and copper temperature.
    fn restart(&mut self) {
        let drive = match self.supply {
            Supply::Volts(_) if self.drawn.coil_ohm.is_infinite() => Drive::still(0.0),
            Supply::Volts(volts) => Drive::still(volts - self.operation_v),
            Supply::Off { suppression_v } => Drive::Suppression {
                volts: suppression_v,
            },
        };
        let ohm = self.copper_ratio() * self.motion.reference_ohm();
        self.motion.set(drive, ohm);
    }
}

#[cfg(test)]
mod tests;
