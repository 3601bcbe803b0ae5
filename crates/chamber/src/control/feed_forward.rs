//! Feed-forward with lag: the inverse of an identified chamber, and the gain that it learns on ramps.
//!
//! The transfer function of a chamber without losses, from power to temperature, is `K/(tau s + 1) + ki/s`. Its inverse
//! turns the rate of the set point into power through one lag of `(K + ki tau)/ki`; to this comes the power that
//! balances losses and fan. On a steady heating ramp the power of the feed-forward over the whole power gives the gain
//! of the present heater, except for what wrong losses explain: insulation that has warmed through loses less than in
//! the identification.

use super::Task;
use crate::ramp::SetPoint;
use crate::tune::Identified;

/// Shortest steady part of a ramp from which the gain is learnt, s.
const LEAST_S: u32 = 90;
/// First part of a ramp, which teaches nothing, s.
const SETTLING_S: u32 = 60;
/// Share of the identified losses that vanishes once the insulation is warm: with two equal faces it then loses half of
/// what it takes up while it is cold.
const LESS_LOSS: f64 = 0.5;
/// Range of the learnt gain.
const GAINS: [f64; 2] = [0.3, 3.0];

/// State of the feed-forward, stepped once a second.
#[derive(Debug, Clone, PartialEq)]
pub struct FeedForward {
    chamber: Identified,
    /// Ratio of the power that the heater has to the identified one.
    gain: f64,
    lagged: f64,
    last: f64,
    /// Part of `last` that smaller losses would save.
    less: f64,
    lesson: Lesson,
}

/// Sums over the steady part of a ramp.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Lesson {
    seconds: u32,
    forward: f64,
    less: f64,
    power: f64,
}

impl FeedForward {
    /// Makes the feed-forward of an identified chamber, with a gain of 1.
    pub fn new(chamber: &Identified) -> Self {
        Self {
            chamber: *chamber,
            gain: 1.0,
            lagged: 0.0,
            last: 0.0,
            less: 0.0,
            lesson: Lesson::default(),
        }
    }

    /// Returns the learnt ratio of the power of the heater to the identified one, 0.3 to 3.
    pub fn gain(&self) -> f64 {
        self.gain
    }

    /// Returns the power that the set point needs, 1 = full heater.
    pub fn step(&mut self, set: &SetPoint, ambient_c: f64) -> f64 {
        let it = &self.chamber;
        let wanted = (set.rate_k_per_s + it.time_constant_s * set.bend_k_per_s2) / it.slope_k_per_s;
        let lag_s = it.gain_k / it.slope_k_per_s + it.time_constant_s;
        self.lagged += (wanted - self.lagged) / lag_s.max(1.0);
        let lost = it.loss_per_k * (set.value_c - ambient_c);
        self.last = (self.lagged + lost - it.fan) / self.gain;
        self.less = LESS_LOSS * lost / self.gain;
        self.last
    }

    /// Takes the power of this second. At the end of a steady heating ramp learns the gain: the one nearest to 1 that,
    /// with the identified losses or smaller ones, explains the power. Returns by how much the power of the feed-forward
    /// drops, 1 = full heater; returns 0 at any other time. A ramp so slow that smaller losses alone explain its power
    /// teaches nothing.
    pub fn learn(&mut self, set: &SetPoint, power: f64, task: &Task) -> f64 {
        let steady =
            set.cruises() && set.rate_k_per_s > 0.0 && power > task.lowest && power < task.highest;
        if steady {
            self.lesson.seconds += 1;
            if self.lesson.seconds > SETTLING_S {
                self.lesson.forward += self.last;
                self.lesson.less += self.less;
                self.lesson.power += power;
            }
            return 0.0;
        }
        let Lesson {
            seconds,
            forward,
            less,
            power,
        } = std::mem::take(&mut self.lesson);
        let least = forward - less.max(0.0);
        let is_telling = least > 0.0 && power > 0.0;
        if seconds < LEAST_S + SETTLING_S || !is_telling {
            return 0.0;
        }
        let before = self.gain;
        let nearest = 1_f64.clamp(before * least / power, before * forward / power);
        self.gain = nearest.clamp(GAINS[0], GAINS[1]);
        let now = self.last * before / self.gain;
        std::mem::replace(&mut self.last, now) - now
    }
}
