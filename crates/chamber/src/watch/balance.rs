//! Energy balance: compares the slope of the sensor with the slope that the model of the chamber makes of the same
//! power.
//!
//! An identification counts as loss what cold walls and insulation take up. After some batches they are warm and take up
//! less, so the balance expects a slope between that with the identified losses and that without any.

use super::lasting::{Lasting, Recent};
use super::{Second, Trouble};
use crate::tune::Identified;
use crate::tune::response::Response;

/// Length of the stretch that gives both slopes, s.
const SLOPE_S: usize = 30;
/// Time for which the slopes must disagree, s; together with [`SLOPE_S`] a minute.
const LASTS_S: u32 = 30;
/// Share of the expected slope by which the slopes may disagree.
const SHARE: f64 = 0.5;
/// Difference of the slopes that is always allowed, K/s.
const FLOOR_K_PER_S: f64 = 1.0 / 60.0;
/// Allowed difference as a share of the slope that the recent power makes: mains voltage varies, and walls may still be
/// cold.
const MODEL_SHARE: f64 = 0.4;
/// Time over which power counts as recent, s.
const RECENT_S: f64 = 120.0;
/// Slope without power that reveals a shorted power unit, K/s, in addition to what fan and walls explain.
const UNPOWERED_K_PER_S: f64 = 0.5 / 60.0;
/// Time without power after which the balance judges the slope, s: until then the heater gives off its heat.
const UNPOWERED_S: u32 = 60;
/// A vent counts as closing when its opening is below its recent maximum by more than this. The air then warms at
/// hotter walls, which the model does not know, so the balance judges no slope until the maximum has decayed: 190 s at
/// most.
const CLOSING: f64 = 0.05;
/// Rate at which the recent maximum of the vent decays, 1/s.
const FORGETS_PER_S: f64 = 0.005;

/// State of the balance, stepped once a second.
#[derive(Debug, Clone, PartialEq)]
pub struct Balance {
    chamber: Identified,
    model: Response,
    measured: Recent,
    modelled: Recent,
    modelled_c: f64,
    /// What the chamber is warmer without its losses: model, and its temperature, K.
    lossless: Response,
    spared: Recent,
    spared_k: f64,
    /// Excess of the chamber over ambient at the last valid reading, K.
    excess_k: f64,
    recent_power: f64,
    off: Lasting,
    unpowered: Lasting,
    /// Recent maximum of the opening of the vent, which decays.
    vent: f64,
}

impl Balance {
    /// Starts at rest.
    pub fn new(chamber: &Identified) -> Self {
        Self {
            chamber: *chamber,
            model: Response::of(chamber),
            measured: Recent::of(SLOPE_S),
            modelled: Recent::of(SLOPE_S),
            modelled_c: 0.0,
            lossless: Response::of(chamber),
            spared: Recent::of(SLOPE_S),
            spared_k: 0.0,
            excess_k: 0.0,
            recent_power: 0.0,
            off: Lasting::of(LASTS_S),
            unpowered: Lasting::of(UNPOWERED_S),
            vent: 0.0,
        }
    }

    /// Compares the slopes of the last half minute. Without a reading the model goes on, and both slopes start again.
    pub fn step(&mut self, now: &Second, control_c: Option<f64>) -> Option<Trouble> {
        self.follow(now, control_c);
        let Some(control_c) = control_c else {
            self.measured.clear();
            self.modelled.clear();
            self.spared.clear();
            self.off.step(false);
            return None;
        };
        self.modelled.push(self.modelled_c);
        self.spared.push(self.spared_k);
        self.measured.push(control_c);
        let recent = self.recent_power.max(now.command.heater) * self.chamber.slope_k_per_s;
        self.vent = (self.vent - FORGETS_PER_S).max(now.command.vent);
        let closes = now.command.vent + CLOSING < self.vent;
        let unpowered = self.unpowered.step(now.command.heater == 0.0 && !closes);
        let (found, expected) = (self.measured.slope()?, self.modelled.slope()?);
        let nearest = found.clamp(expected, expected + self.spared.slope()?.max(0.0));
        let heats = unpowered && found > UNPOWERED_K_PER_S + expected.max(0.0);
        let most = (SHARE * expected.abs())
            .max(MODEL_SHARE * recent)
            .max(FLOOR_K_PER_S);
        let off = self.off.step(!closes && (found - nearest).abs() > most);
        match (heats, off) {
            (true, _) => Some(Trouble::HeatWithoutCommand),
            (false, true) => Some(Trouble::EnergyBalance),
            (false, false) => None,
        }
    }

    /// Advances the model by a second.
    fn follow(&mut self, now: &Second, control_c: Option<f64>) {
        let it = &self.chamber;
        let excess_k = control_c.map(|control_c| control_c - now.ambient_c);
        self.excess_k = excess_k.unwrap_or(self.excess_k);
        let loss = it.loss_per_k * self.excess_k;
        let lost = loss + it.vent_per_k * now.command.vent * self.excess_k;
        self.spared_k += self.lossless.step(loss);
        self.modelled_c += self
            .model
            .step(now.command.heater * now.gain + it.fan - lost);
        self.recent_power += (now.command.heater - self.recent_power) / RECENT_S;
    }
}
