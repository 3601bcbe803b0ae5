//! Bodies that touch where they must not: the truth of `parry3d` about shapes read from `scene.toml`.
//!
//! Nothing of the controller's guard is in here: other code, other library, no margins. Two bodies that press into each
//! other deeper than their pair allows have crashed; a pair that nobody names may not touch at all. Where a pair names
//! the actuators that may press it together, no other one may move the two against each other while they touch.
//!
//! Between two events of the mechanism everything moves on a known course. [`Bodies::watch`] looks back over such a
//! span, only at bodies that moved and only at pairs whose swept boxes meet, in steps of [`STEP_MM`] of the longer way.
//! Without the feature `bodies` the rig has the stand-in of `unwatched.rs` instead.

mod body;
mod meeting;
mod scene;
mod shape;

use std::collections::BTreeSet;
use std::path::Path;

use parry3d_f64::bounding_volume::{Aabb, BoundingVolume};

use super::posture::{ACTUATORS, Posture};
use crate::config::ConfigError;
use body::{Body, PARTS, depth_mm, element, parts};
use meeting::{Meeting, meeting};
use scene::{Scene, Size};

/// A body that moves further is looked at more than once, mm: as long as the thinnest solid of the scene is wide.
const STEP_MM: f64 = 2.0;
/// Bodies that stand side by side are apart by less than this in floating point, mm.
const ROUNDING_MM: f64 = 1e-9;

/// True: this program looks for bodies that touch.
pub const WATCHED: bool = true;

/// All bodies of the rig.
#[derive(Debug, Clone)]
pub struct Bodies {
    bodies: Vec<Body>,
    meetings: Vec<Meeting>,
    strokes: [f64; 8],
}

impl Bodies {
    /// The bodies of a folder of settings, with parts of the size of a recipe.
    ///
    /// # Errors
    /// `scene.toml` or the recipe cannot be read, or names what is not there.
    pub fn read(dir: &Path, recipe: &str) -> Result<Self, ConfigError> {
        let (scene, size) = scene::read(dir, recipe)?;
        Ok(Self::new(&scene, &size))
    }

    fn new(scene: &Scene, size: &Size) -> Self {
        let mut bodies: Vec<Body> = scene.elements.iter().map(|it| element(scene, it)).collect();
        bodies.extend(parts(scene, size));
        let strokes = ACTUATORS.map(|name| scene.stroke_mm(name));
        let mut meetings = Vec::new();
        for a in 0..bodies.len() {
            for b in a + 1..bodies.len() {
                meetings.extend(meeting(scene, &bodies, (a, b)));
            }
        }
        Self {
            bodies,
            meetings,
            strokes,
        }
    }

    /// Stroke of an actuator, mm; 0 for one that has points.
    pub fn stroke_mm(&self, actuator: usize) -> f64 {
        self.strokes[actuator]
    }

    /// Looks at a span from `from` to `to`, in which no part changes its place; `between` tells the posture at a share
    /// of it, 0 to 1. Gives the pairs that touched in it; those of `touching` had touched before.
    pub fn watch(
        &self,
        from: &Posture,
        to: &Posture,
        between: impl Fn(f64) -> Posture,
        touching: &mut BTreeSet<(usize, usize)>,
    ) -> Vec<String> {
        let moved: [bool; 8] = std::array::from_fn(|n| from.mm[n] != to.mm[n]);
        let there = |(n, body): (usize, &Body)| self.is_there(n, to).then(|| body.swept(from, to));
        let boxes: Vec<Option<Aabb>> = self.bodies.iter().enumerate().map(there).collect();
        let mut found = Vec::new();
        for meeting in self.meetings.iter().filter(|it| it.is_moved(&moved)) {
            let (Some(one), Some(other)) = (boxes[meeting.pair.0], boxes[meeting.pair.1]) else {
                touching.remove(&meeting.pair);
                continue;
            };
            let depth_mm = match one.intersects(&other) {
                true => self.deepest_mm(meeting.pair, (from, to), &between),
                false => f64::NEG_INFINITY,
            };
            if depth_mm <= meeting.allowed(&moved, to.slack) + ROUNDING_MM {
                touching.remove(&meeting.pair);
            } else if touching.insert(meeting.pair) {
                let (a, b) = (&self.bodies[meeting.pair.0], &self.bodies[meeting.pair.1]);
                found.push(format!("{} and {}, {depth_mm:.2} mm deep", a.name, b.name));
            }
        }
        found
    }

    /// How deep two bodies are in each other at most on their way, mm.
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

    /// Parts are where the posture says.
    fn is_there(&self, body: usize, posture: &Posture) -> bool {
        let first = self.bodies.len() - PARTS.len();
        let there = [posture.pocket, posture.pushed, posture.nest, posture.held];
        body.checked_sub(first).is_none_or(|place| there[place])
    }

    /// How far two bodies move against each other, mm at most.
    fn way_mm(&self, (a, b): (usize, usize), from: &Posture, to: &Posture) -> f64 {
        (0..ACTUATORS.len())
            .map(|n| {
                let against = self.bodies[a].moves[n] - self.bodies[b].moves[n];
                against.length() * (to.mm[n] - from.mm[n]).abs()
            })
            .sum()
    }
}
