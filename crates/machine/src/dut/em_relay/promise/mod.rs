//! Tests the promises of `rig.toml` (`[accuracy]`) and of the recipe on residuals of this kind's measurements.
//!
//! | promise | residuals |
//! |---|---|
//! | noise of the analog inputs | repeated conversions of constant references during the calibration ([`super::reference::noise`]) |
//! | scatter of operations | repeated fine ramps of one part: each reference part of a calibration, and parts near a limit ([`operation`]) |
//! | scatter of closures | closures of one part's NC contact ([`closure`]) |
//! | temperature of part minus track | operate voltages of the reference parts of a calibration ([`super::reference_part`]) |
//!
//! From the alarm on, budgets use the observed value; parts judged before keep the promised one. The five reference
//! parts of a calibration can disprove only a gross error of the temperature. Every calibration therefore pools what
//! they show with the promise, weighted by the uncertainty that `rig.toml` states for it
//! ([`Promises::part_minus_track_k`]).

mod closure;
mod operation;
mod watch;

use super::measure::Context;
use crate::dut::promise::{Broken, Promise};
use crate::gauge::evidence::{Residuals, freedom_of};
use crate::gauge::{Deviation, Evidence};
use std::sync::Arc;

/// Greatest rate of false alarms: the share of the lots in which a promise that holds raises its alarm.
const FALSE_ALARMS: f64 = 5e-5;

/// Promises and the evidence against them.
#[derive(Debug, Clone)]
pub struct Promises {
    /// One entry for each promise, at the index of the promise.
    watched: Vec<Watched>,
    /// Broken promises that the station has not announced yet.
    new: Vec<Promise>,
}

/// A promise with the evidence against it.
#[derive(Debug, Clone)]
struct Watched {
    promise: Promise,
    /// Promised value, in the unit of its key.
    promised: f64,
    evidence: Evidence,
    broken: Option<Broken>,
}

impl Promises {
    /// Makes the promises of rig and recipe; marks those as broken that a stored calibration has disproved.
    pub fn new(context: &Context) -> Self {
        let stored = &context.calibration.broken;
        let watched = Promise::ALL.iter().map(|&promise| {
            let promised = promised(context, promise);
            let mut stored = stored.iter().filter(|it| it.promise == promise);
            Watched {
                promise,
                promised,
                evidence: Evidence::default(),
                // A promise is not broken if `rig.toml` has since been changed to promise at least the value in use.
                broken: stored.find(|it| it.used > promised).copied(),
            }
        });
        let watched: Vec<Watched> = watched.collect();
        let broken = watched.iter().filter_map(|it| it.broken);
        Self {
            new: broken.map(|it| it.promise).collect(),
            watched,
        }
    }

    /// Returns the value that the configuration promises, in the unit of the promise's key.
    pub fn promised(&self, promise: Promise) -> f64 {
        self.watched[promise.index()].promised
    }

    /// Returns the promises that do not hold.
    pub fn broken(&self) -> Vec<Broken> {
        self.watched.iter().filter_map(|it| it.broken).collect()
    }

    /// Returns the promises that do not hold and are not announced yet.
    pub fn announce(&mut self) -> Vec<Broken> {
        let new = std::mem::take(&mut self.new);
        let mut broken = self.broken();
        broken.retain(|it| new.contains(&it.promise));
        broken
    }

    /// Returns the difference between part and track, kelvin: the promise, whose relative uncertainty is `u_pct`
    /// percent, pooled with what the reference parts show.
    pub fn part_minus_track_k(&self, u_pct: f64) -> Deviation {
        let watched = &self.watched[Promise::PartMinusTrack.index()];
        let pooled = watched.evidence.pooled(freedom_of(u_pct));
        pooled.times(watched.promised)
    }

    /// Makes the budgets of `context` use the larger of the promised and the observed values. The calibration of
    /// `context` already contains the temperature of the parts.
    pub fn apply(&self, context: &mut Context) {
        let accuracy = &mut context.accuracy;
        for it in &self.watched {
            let used = it.broken.map_or(it.promised, |broken| broken.used);
            match it.promise {
                Promise::AiNoise => accuracy.ai_noise_lsb = used,
                Promise::OperationScatter => accuracy.operation_scatter_mv = used,
                Promise::PartMinusTrack => {}
                Promise::ClosureScatter => {
                    let relay = Arc::make_mut(&mut context.relay);
                    relay.test.strategy.contact.closure_scatter_pct = used.ceil() as u32;
                }
            }
        }
    }

    /// Discards the evidence because a new calibration begins; the promises count as holding again.
    pub fn restart(&mut self) {
        self.new.clear();
        for it in &mut self.watched {
            it.evidence = Evidence::default();
            it.broken = None;
        }
    }

    /// Adds residuals; a promise that they disprove counts as broken from now on, with the newest figures.
    pub fn observe(&mut self, promise: Promise, residuals: impl IntoIterator<Item = Residuals>) {
        let watched = &mut self.watched[promise.index()];
        let was_broken = watched.broken.is_some();
        watched.observe(residuals);
        if watched.broken.is_some() && !was_broken {
            self.new.push(promise);
        }
    }
}

impl Watched {
    fn observe(&mut self, residuals: impl IntoIterator<Item = Residuals>) {
        residuals.into_iter().for_each(|it| self.evidence.add(it));
        let seen = self.evidence.seen();
        let Some(seen) = seen.filter(|_| self.evidence.disproves(FALSE_ALARMS)) else {
            return;
        };
        self.broken = Some(Broken {
            promise: self.promise,
            promised: self.promised,
            seen: self.promised * seen.value,
            interval: (
                self.promised * seen.interval.0,
                self.promised * seen.interval.1,
            ),
            freedom: seen.freedom,
            used: self.promised * self.evidence.covering(),
        });
    }
}

/// Returns the promised value that the budgets of `context` use, in the unit of its key.
fn promised(context: &Context, promise: Promise) -> f64 {
    match promise {
        Promise::AiNoise => context.accuracy.ai_noise_lsb,
        Promise::OperationScatter => context.accuracy.operation_scatter_mv,
        Promise::ClosureScatter => {
            f64::from(context.relay.test.strategy.contact.closure_scatter_pct)
        }
        Promise::PartMinusTrack => context.accuracy.part_minus_track_k,
    }
}

#[cfg(test)]
mod tests;
