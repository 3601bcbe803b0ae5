//! Plausibility of readings and energy balance: checks that name their trouble, stepped once a second.
//!
//! | trouble | raised when |
//! |---|---|
//! | sensor broken | a reading is missing |
//! | sensor jump | a reading moves by more than 3 K in a second |
//! | sensors differ | control and reference are apart by more than 1.0 K + 0.1 min × rate for 10 s; rate of the set point, or of one towards the other |
//! | sensor stuck | a reading changes by less than 0.02 K in 60 s above 30 % power |
//! | energy balance | the slope differs from the expected one by more than half for 60 s: open heater, low mains, door |
//! | energy balance | the surface of the heater exceeds the air by less than a quarter of what its power makes, for 10 s: open heater |
//! | heat without command | the chamber warms by more than 0.5 K/min without power for 60 s: power unit shorted |
//! | over set point | the reading exceeds the set point by 5 K |
//! | ramp not reached, cooling too slow | the set point waits, and the chamber moves by less than 1 K in 5 minutes |

pub mod balance;
pub mod heater;
mod lasting;
pub mod sensors;
pub mod slope;
pub mod unpowered;

use crate::control::split_range::Command;
use crate::ramp::SetPoint;
use crate::tune::Identified;
use balance::Balance;
use lasting::Recent;
use sensors::Sensors;

/// Excess over the set point, K.
const OVER_K: f64 = 5.0;
/// The chamber does not follow when it moves by less than this within `STILL_S` while the set point waits, K.
const STILL_K: f64 = 1.0;
const STILL_S: usize = 300;

/// Trouble that readings of a chamber reveal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Trouble {
    /// A sensor has no reading.
    SensorBroken,
    /// A reading moved faster than the air can.
    SensorJump,
    /// Control and reference sensor disagree.
    SensorsDiffer,
    /// A reading does not change although the heater has power.
    SensorStuck,
    /// The slope does not fit the power.
    EnergyBalance,
    /// The chamber heats up without command.
    HeatWithoutCommand,
    /// The chamber is far above its set point.
    OverSetPoint,
    /// The chamber does not reach the rate of the ramp.
    RampNotReached,
    /// The chamber does not cool.
    CoolingTooSlow,
}

/// Readings and command of one second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Second {
    /// Control sensor, C; `None` without a valid reading.
    pub control_c: Option<f64>,
    /// Reference sensor, C; `None` without a valid reading.
    pub reference_c: Option<f64>,
    /// Temperature around the chamber, C.
    pub ambient_c: f64,
    /// Set point.
    pub set: SetPoint,
    /// Command of this second.
    pub command: Command,
    /// Learnt ratio of the power of the heater to the identified one.
    pub gain: f64,
}

/// State of all checks of a running chamber.
#[derive(Debug, Clone, PartialEq)]
pub struct Watch {
    sensors: Sensors,
    balance: Balance,
    still: Recent,
}

impl Watch {
    /// Starts with an identified chamber.
    pub fn new(chamber: &Identified) -> Self {
        Self {
            sensors: Sensors::default(),
            balance: Balance::new(chamber),
            still: Recent::of(STILL_S),
        }
    }

    /// Checks a second; returns each trouble that is present, the gravest first. A reading that is not finite counts as
    /// missing; after a gap the checks that look back begin anew.
    pub fn step(&mut self, now: &Second) -> Vec<Trouble> {
        let readings = [now.control_c, now.reference_c];
        let [control_c, _] = readings.map(|it| it.filter(|it| it.is_finite()));
        let rate_k_per_min = 60.0 * now.set.rate_k_per_s.abs();
        let mut found = self
            .sensors
            .step(readings, rate_k_per_min, now.command.heater);
        found.extend(self.balance.step(now, control_c));
        let over = control_c.is_some_and(|it| it > now.set.value_c + OVER_K);
        found.extend(over.then_some(Trouble::OverSetPoint));
        found.extend(self.stands_still(now, control_c));
        found.sort();
        found.dedup();
        found
    }

    fn stands_still(&mut self, now: &Second, control_c: Option<f64>) -> Option<Trouble> {
        if !now.set.waits || control_c.is_none() {
            self.still.clear();
        }
        self.still.push(control_c?);
        let still = self.still.range().is_some_and(|it| it < STILL_K);
        still.then_some(match now.set.rate_k_per_s > 0.0 {
            true => Trouble::RampNotReached,
            false => Trouble::CoolingTooSlow,
        })
    }
}

#[cfg(test)]
mod tests;
