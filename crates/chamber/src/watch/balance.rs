//! Energy balance: compares the slope of the sensor with the slope that the model of the chamber computes from the same
//! power.
//!
//! An identification counts as loss what cold walls and insulation take up. After some batches they are warm and take up
//! less. So the balance accepts any slope between those of three models: the identified one, the same with the learnt gain,
//! and the same without losses.

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
/// Allowed difference as a share of the slope that the recent power causes: mains voltage varies, and walls may still
/// be cold.
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

/// The chamber by one model.
#[derive(Debug, Clone, PartialEq)]
struct Model {
    response: Response,
    celsius: f64,
    recent: Recent,
}

impl Model {
    fn of(chamber: &Identified) -> Self {
        Self {
            response: Response::of(chamber),
            celsius: 0.0,
            recent: Recent::of(SLOPE_S),
        }
    }

    /// Advances by a second with this net power, 1 = full heater.
    fn step(&mut self, power: f64) {
        self.celsius += self.response.step(power);
        self.recent.push(self.celsius);
    }
}

/// State of the balance, stepped once a second.
#[derive(Debug, Clone, PartialEq)]
pub struct Balance {
    chamber: Identified,
    measured: Recent,
    /// Identified model, the same with the learnt gain, and without losses.
    models: [Model; 3],
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
            measured: Recent::of(SLOPE_S),
            models: [(); 3].map(|()| Model::of(chamber)),
            excess_k: 0.0,
            recent_power: 0.0,
            off: Lasting::of(LASTS_S),
            unpowered: Lasting::of(UNPOWERED_S),
            vent: 0.0,
        }
    }

    /// Compares the slopes of the last half minute. Without a reading the models go on, and the measured slope starts
    /// again.
    pub fn step(&mut self, now: &Second, control_c: Option<f64>) -> Option<Trouble> {
        self.follow(now, control_c);
        let Some(control_c) = control_c else {
            self.measured.clear();
            self.off.step(false);
            return None;
        };
        self.measured.push(control_c);
        let recent = self.recent_power.max(now.command.heater) * self.chamber.slope_k_per_s;
        self.vent = (self.vent - FORGETS_PER_S).max(now.command.vent);
        let closes = now.command.vent + CLOSING < self.vent;
        let unpowered = self.unpowered.step(now.command.heater == 0.0 && !closes);
        let found = self.measured.slope()?;
        let [identified, learnt, lossless] = self.models.each_ref().map(|it| it.recent.slope());
        let (identified, learnt, lossless) = (identified?, learnt?, lossless?);
        let heats = unpowered && found > UNPOWERED_K_PER_S + identified.max(0.0);
        let low = identified.min(learnt).min(lossless);
        let expected = found.clamp(low, identified.max(learnt).max(lossless));
        let most = (SHARE * expected.abs())
            .max(MODEL_SHARE * recent)
            .max(FLOOR_K_PER_S);
        let off = self.off.step(!closes && (found - expected).abs() > most);
        match (heats, off) {
            (true, _) => Some(Trouble::HeatWithoutCommand),
            (false, true) => Some(Trouble::EnergyBalance),
            (false, false) => None,
        }
    }

    /// Advances the models by a second.
    fn follow(&mut self, now: &Second, control_c: Option<f64>) {
        let it = &self.chamber;
        let excess_k = control_c.map(|control_c| control_c - now.ambient_c);
        self.excess_k = excess_k.unwrap_or(self.excess_k);
        let loss = it.loss_per_k * self.excess_k;
        let heater = now.command.heater;
        let others = it.fan - it.vent_per_k * now.command.vent * self.excess_k;
        let powers = [heater - loss, heater * now.gain - loss, heater];
        for (model, power) in self.models.iter_mut().zip(powers) {
            model.step(power + others);
        }
        self.recent_power += (heater - self.recent_power) / RECENT_S;
    }
}
