//! Detection of crashes: exact distances by `parry3d` between shapes from `scene.toml`.
//!
//! This check shares nothing with the controller's guard: other code, other library, no margins. Two bodies crash
//! when they press into each other deeper than their pair permits; a pair that the scene omits must not touch at
//! all. A pair that lists actuators may press deeper only through these.
//!
//! Between two events of the mechanism every motion is known. [`Bodies::watch`] checks such an interval for the pairs
//! that move relative to each other and whose swept boxes meet, in steps of [`STEP_MM`] of their relative travel.
//! Without the feature `bodies`, `no_bodies.rs` replaces this module.

mod body;
mod pair_limits;
mod scene;
mod shape;

use std::collections::BTreeSet;

use parry3d_f64::bounding_volume::{Aabb, BoundingVolume};

use super::posture::{ACTUATORS, Posture};
use crate::config::{ConfigError, Files};
use body::{Body, PARTS, depth_mm, element, parts};
use pair_limits::{PairLimits, mask, pair_limits};
use scene::{Scene, Size};

/// Longest relative travel between two checks, mm: the width of the thinnest solid of the scene.
const STEP_MM: f64 = 2.0;
/// Largest rounding error in the distance of two bodies side by side, mm.
const ROUNDING_MM: f64 = 1e-9;

/// True: this program detects crashes.
pub const WATCHED: bool = true;

/// All bodies of the rig.
#[derive(Debug, Clone)]
pub struct Bodies {
    bodies: Vec<Body>,
    limits: Vec<PairLimits>,
    strokes: [f64; 8],
}

impl Bodies {
    /// Reads the bodies of a configuration, with parts of the size of a recipe.
    ///
    /// # Errors
    /// Fails when `scene.toml` or the recipe cannot be read, or refers to an unknown name.
    pub fn read(files: &Files, recipe: &str) -> Result<Self, ConfigError> {
        let (scene, size) = scene::read(files, recipe)?;
        Ok(Self::new(&scene, &size))
    }

    fn new(scene: &Scene, size: &Size) -> Self {
        let mut bodies: Vec<Body> = scene.elements.iter().map(|it| element(scene, it)).collect();
        bodies.extend(parts(scene, size));
        let strokes = ACTUATORS.map(|name| scene.stroke_mm(name));
        let mut limits = Vec::new();
        for a in 0..bodies.len() {
            for b in a + 1..bodies.len() {
                limits.extend(pair_limits(scene, &bodies, (a, b)));
            }
        }
        Self {
            bodies,
            limits,
            strokes,
        }
    }

    /// Returns the stroke of an actuator, mm; 0 for an actuator with a point table.
    pub fn stroke_mm(&self, actuator: usize) -> f64 {
        self.strokes[actuator]
    }

    /// Checks the interval from `from` to `to`, during which every part keeps its place; `between` returns the posture
    /// at a fraction of the interval, 0 to 1. Returns a description of each new crash; `touching` holds the pairs that
    /// already touch.
    pub fn watch(
        &self,
        from: &Posture,
        to: &Posture,
        between: impl Fn(f64) -> Posture,
        touching: &mut BTreeSet<(usize, usize)>,
    ) -> Vec<String> {
        let moved = mask(|n| from.mm[n] != to.mm[n]);
        let mut boxes: Vec<Option<Aabb>> = vec![None; self.bodies.len()];
        let mut swept = |n: usize| {
            let there = self.is_there(n, to);
            there.then(|| *boxes[n].get_or_insert_with(|| self.bodies[n].swept(from, to)))
        };
        let mut found = Vec::new();
        for limit in self.limits.iter().filter(|it| it.is_moved(moved)) {
            let (Some(one), Some(other)) = (swept(limit.pair.0), swept(limit.pair.1)) else {
                touching.remove(&limit.pair);
                continue;
            };
            let depth_mm = match one.intersects(&other) {
                true => self.deepest_mm(limit.pair, (from, to), &between),
                false => f64::NEG_INFINITY,
            };
            if depth_mm <= limit.allowed(moved, to.slack) + ROUNDING_MM {
                touching.remove(&limit.pair);
            } else if touching.insert(limit.pair) {
                let (a, b) = (&self.bodies[limit.pair.0], &self.bodies[limit.pair.1]);
                found.push(format!("{} and {}, {depth_mm:.2} mm deep", a.name, b.name));
            }
        }
        found
    }

    /// Returns the greatest depth to which two bodies penetrate each other along their way, mm.
    fn deepest_mm(
        &self,
        pair: (usize, usize),
        (from, to): (&Posture, &Posture),
        between: &impl Fn(f64) -> Posture,
    ) -> f64 {
        let (a, b) = (&self.bodies[pair.0], &self.bodies[pair.1]);
        let steps = (self.way_mm(pair, from, to) / STEP_MM).ceil().max(1.0) as u32;
        let share = |n: u32| f64::from(n) / f64::from(steps);
        (0..=steps)
            .map(|n| depth_mm(a, b, &between(share(n))))
            .fold(f64::NEG_INFINITY, f64::max)
    }

    /// Checks whether the body exists in the posture: a part exists only at its present place.
    fn is_there(&self, body: usize, posture: &Posture) -> bool {
        let first = self.bodies.len() - PARTS.len();
        let there = [posture.pocket, posture.pushed, posture.nest, posture.held];
        body.checked_sub(first).is_none_or(|place| there[place])
    }

    /// Returns an upper bound of the relative travel of two bodies, mm.
    fn way_mm(&self, (a, b): (usize, usize), from: &Posture, to: &Posture) -> f64 {
        (0..ACTUATORS.len())
            .map(|n| {
                let against = self.bodies[a].moves[n] - self.bodies[b].moves[n];
                against.length() * (to.mm[n] - from.mm[n]).abs()
            })
            .sum()
    }
}
