//! Fits the parameters of the relay model to the thresholds and times of a drawn specimen.
//!
//! The world file draws results: thresholds, times, resistance. The model needs parameters, so the fit adjusts those of
//! the default relay until its results match:
//!
//! - spring and travel together determine the pickup threshold (both depend on the same bent part),
//! - the reluctance of the closed iron determines the release threshold,
//! - mass of the armature and conductance of the eddy currents determine operate and release time.
//!
//! Newton's method on the exact statics fits the thresholds first; they do not depend on mass or eddy currents.
//! Broyden's method on whole transients then fits the times. All parameters are logarithms, so that none becomes
//! negative. About one in thirty drawn pairs of times is impossible, because a heavy armature does not fall fast; then
//! the operate time is exact and the release time as close as possible. A slow relay has friction at its hinge, or iron
//! that holds the flux: bisection fits that one parameter, and the other time follows from it.

use std::ops::Range;

use super::lumped::{Drive, Element, Model, Parameters, State};
use super::motion::Motion;

/// Results that the fitted relay must show, at 23 C.
#[derive(Debug, Clone, Copy)]
pub struct FitTarget {
    /// Coil resistance, ohm.
    pub coil_ohm: f64,
    /// Number of turns relative to the default relay.
    pub turns: f64,
    /// Quasi-static pickup and release thresholds, V.
    pub volts: [f64; 2],
    /// Operate time from rest at nominal voltage, and release time from nominal voltage into the zener, s.
    pub seconds: [f64; 2],
    /// Nominal coil voltage, V.
    pub nominal_v: f64,
    /// Suppression voltage of the timed release, V.
    pub zener_v: f64,
    /// Origin of the two times.
    pub time_origin: TimeOrigin,
}

/// Origin of a relay's operate time and release time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TimeOrigin {
    /// The lot draws both.
    Lot,
    /// Neither is drawn: both follow from springs and winding.
    Follows,
    /// The lot draws the operate time; friction at the hinge makes it long, and the release time follows.
    Hinge,
    /// The lot draws the release time; iron that holds the flux makes it long, and the operate time follows.
    Iron,
}

/// Relative error up to which a time counts as matched: 0.5 us in 5 ms.
const GOOD: f64 = 1e-4;
/// Upper limit of the operate time and release time of any relay, s.
const LONGEST_S: f64 = 0.04;
/// Largest change of a parameter from the default relay, natural logarithm.
const FURTHEST: f64 = 3.5;
/// Largest change of mass and eddy currents of a sound relay, natural logarithm: a factor of seven.
const PLAUSIBLE: f64 = 2.0;
/// Logarithmic slopes of operate and release time (rows) over mass and eddy currents (columns) of the default relay.
/// Broyden's method starts from them; they do not affect the result.
const SLOPES: [[f64; 2]; 2] = [[0.25, 0.1], [0.25, 0.45]];

impl FitTarget {
    /// Returns parameters whose results are as close to the targets as the limits allow.
    pub fn fit(&self, base: &Parameters) -> Parameters {
        let mut p = *base;
        p.T = 23.0;
        p.R23 = self.coil_ohm;
        p.N = base.N * self.turns;
        let p = self.with_thresholds(&p);
        match self.time_origin {
            TimeOrigin::Lot => self.with_times(&p),
            TimeOrigin::Follows => p,
            TimeOrigin::Hinge => self.with_one(
                0,
                |x| Parameters {
                    c_a: p.c_a * x.exp(),
                    ..p
                },
                0.0..6.0,
            ),
            TimeOrigin::Iron => self.with_one(
                1,
                |x| Parameters {
                    k_ec: p.k_ec * x.exp(),
                    ..p
                },
                0.0..FURTHEST,
            ),
        }
    }

    fn with_thresholds(&self, p: &Parameters) -> Parameters {
        let bent = |[spring, iron]: [f64; 2]| Parameters {
            F_r0: p.F_r0 * spring.exp(),
            X: p.X * (0.5 * spring).exp(),
            Rr: p.Rr * iron.exp(),
            Rc0: p.Rc0 * iron.exp(),
            ..*p
        };
        let off = |at: [f64; 2]| {
            let model = Model::new(&bent(at));
            [
                (model.pickup().volts / self.volts[0]).ln(),
                (model.release().volts / self.volts[1]).ln(),
            ]
        };
        let mut at = [0.0, 0.0];
        for _ in 0..20 {
            let now = off(at);
            if size(now) < 1e-13 {
                break;
            }
            let d = 1e-6;
            let [one, two] = [off([at[0] + d, at[1]]), off([at[0], at[1] + d])];
            let slopes = [0, 1].map(|i| [(one[i] - now[i]) / d, (two[i] - now[i]) / d]);
            let Some(step) = solved(slopes, now) else {
                break;
            };
            at = [0, 1].map(|i| (at[i] - step[i].clamp(-0.5, 0.5)).clamp(-FURTHEST, FURTHEST));
        }
        bent(at)
    }

    fn with_times(&self, p: &Parameters) -> Parameters {
        let bent = |[mass, eddy]: [f64; 2]| Parameters {
            m_a: p.m_a * mass.exp(),
            k_ec: p.k_ec * eddy.exp(),
            ..*p
        };
        let off = |at: [f64; 2]| {
            let model = Model::new(&bent(at));
            let seconds = [self.operate_s(&model), self.release_s(&model)];
            [0, 1].map(|i| (seconds[i] / self.seconds[i]).ln())
        };
        let (mut at, mut slopes) = ([0.0, 0.0], SLOPES);
        let mut now = off(at);
        for _ in 0..12 {
            if size(now) < GOOD {
                break;
            }
            let Some(step) = solved(slopes, now) else {
                break;
            };
            let next =
                [0, 1].map(|i| (at[i] - step[i].clamp(-0.7, 0.7)).clamp(-PLAUSIBLE, PLAUSIBLE));
            let moved = [next[0] - at[0], next[1] - at[1]];
            let then = off(next);
            let square = moved[0] * moved[0] + moved[1] * moved[1];
            if square == 0.0 {
                break;
            }
            for (i, row) in slopes.iter_mut().enumerate() {
                let missed = then[i] - now[i] - row[0] * moved[0] - row[1] * moved[1];
                row[0] += missed * moved[0] / square;
                row[1] += missed * moved[1] / square;
            }
            (at, now) = (next, then);
        }
        match size(now) < GOOD {
            true => bent(at),
            false => self.with_one(0, |mass| bent([mass, at[1]]), -PLAUSIBLE..PLAUSIBLE),
        }
    }

    /// Fits one time by a single parameter, with which the time grows.
    fn with_one(
        &self,
        which: usize,
        bent: impl Fn(f64) -> Parameters,
        within: Range<f64>,
    ) -> Parameters {
        let (mut low, mut high) = (within.start, within.end);
        while high - low > GOOD {
            let middle = 0.5 * (low + high);
            let model = Model::new(&bent(middle));
            let seconds = if which == 0 {
                self.operate_s(&model)
            } else {
                self.release_s(&model)
            };
            if seconds < self.seconds[which] {
                low = middle;
            } else {
                high = middle;
            }
        }
        bent(low)
    }

    /// Returns the time from rest at nominal voltage to the first make of NO, s.
    pub fn operate_s(&self, model: &Model) -> f64 {
        first_make(
            model,
            model.at_rest(0.0),
            &Drive::still(self.nominal_v),
            Element::No,
        )
    }

    /// Returns the time from nominal voltage into the zener to the first make of NC, s.
    pub fn release_s(&self, model: &Model) -> f64 {
        let sealed = model.sealed(self.nominal_v);
        first_make(
            model,
            sealed,
            &Drive::Suppression {
                volts: self.zener_v,
            },
            Element::Nc,
        )
    }
}

/// Returns the instant of the first make of a contact after a start in equilibrium, s; [`LONGEST_S`] if it never makes.
fn first_make(model: &Model, start: State, drive: &Drive, contact: Element) -> f64 {
    let mut motion = Motion::from_equilibrium(model.clone(), 0.0, *drive, start);
    while let Ok(Some(event)) = motion.try_advance(LONGEST_S) {
        if event.element == contact && event.on {
            return event.t_s;
        }
    }
    LONGEST_S
}

fn size([a, b]: [f64; 2]) -> f64 {
    a.abs().max(b.abs())
}

/// Solves two linear equations; `None` for a singular matrix.
fn solved([[a, b], [c, d]]: [[f64; 2]; 2], [x, y]: [f64; 2]) -> Option<[f64; 2]> {
    let det = a * d - b * c;
    (det.abs() > 1e-12).then(|| [(d * x - b * y) / det, (a * y - c * x) / det])
}
