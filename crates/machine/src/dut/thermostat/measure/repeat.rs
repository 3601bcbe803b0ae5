//! The slow repeat: when parts lie within U of a limit after the last pass, the batch gets another one, slower and only
//! through the temperatures of these parts. Its events join the estimate, so that U of these parts shrinks.

use super::super::Parameter;
use super::super::device::{Device, SENSOR_LAG_S};
use super::contacts::Events;
use super::results::{Site, lot};
use crate::gauge::judgement::Rule;
use chamber::lag::{Noise, Record, Value, estimate};
use chamber::plan::is_near_limit;
use chamber::program::Pass;

/// A part of the batch with the events of its contact so far.
#[derive(Debug, Clone)]
pub struct Shown {
    /// Number of the socket.
    pub socket: u16,
    /// Switchings and stray bursts of the contact.
    pub events: Events,
}

/// Returns the slow repeat that these parts need; `None` when every part is clear of its limits, or when the recipe judges
/// bare values.
pub fn pass(device: &Device, record: &Record, parts: &[Shown], ambient_c: f64) -> Option<Pass> {
    match device.recipe.decision.rule {
        Rule::GuardBand => {}
        Rule::Simple => return None,
    }
    let events: Vec<Events> = parts.iter().map(|it| it.events.clone()).collect();
    let (lag, _, scatter_k) = lot(device, record, &events);
    let noise = Noise {
        scatter_k,
        sensor_lag_s: SENSOR_LAG_S,
    };
    let near = |part: &Shown| {
        let found = estimate(record, &part.events.switching, &lag, &noise)?;
        let site = Site::of(device, part.socket, ambient_c);
        let (corrected, of) = (site.corrected(found), site.calibrations());
        let absolute = |it: Value| {
            let budget = of.of_temperature(it.value - ambient_c, it.u_k);
            (it.value, budget.expanded_k())
        };
        let relative = |it: Value| (it.value, of.of_differential(it.value, it.u_k).expanded_k());
        let (operate, reset) = (corrected.operate?, corrected.reset?);
        let all = [
            (Parameter::Operate, absolute(operate)),
            (Parameter::Reset, absolute(reset)),
            (Parameter::Differential, relative(corrected.differential?)),
        ];
        let is_near = all.iter().any(|(of, (value, u_k))| {
            let limit = device.recipe.limits.of(*of);
            let limits: Vec<f64> = limit.low.into_iter().chain(limit.high).collect();
            is_near_limit(*value, *u_k, &limits)
        });
        let u_k = all.iter().map(|(_, (_, u_k))| *u_k).fold(0.0, f64::max);
        is_near.then_some(([found.operate?.value, found.reset?.value], u_k))
    };
    let (places, u_k): (Vec<[f64; 2]>, Vec<f64>) = parts.iter().filter_map(near).unzip();
    let u_k = u_k.into_iter().fold(0.0, f64::max);
    device.thermostat.strategy().repeat(&places, u_k)
}
