//! Permitted penetration depth of a pair of bodies, depending on the actuators that press them together.

use super::body::Body;
use super::scene::{Rule, Scene};
use crate::world::posture::ACTUATORS;

/// Limits of a pair of bodies.
#[derive(Debug, Clone)]
pub struct PairLimits {
    /// Indices in the list of bodies.
    pub pair: (usize, usize),
    /// Actuators that move the two bodies relative to each other, bit n = actuator n.
    by: u8,
    /// Permitted depth for any actuator, mm.
    depth_mm: f64,
    /// Greater depth, mm, and the actuators that may press the pair so deep; it applies unless another actuator moves
    /// the pair.
    deeper: Option<(f64, u8)>,
}

impl PairLimits {
    /// Checks whether one of the moved actuators (bit n = actuator n) moves the two bodies relative to each other.
    pub fn is_moved(&self, moved: u8) -> bool {
        self.by & moved != 0
    }

    /// Returns the permitted depth while these actuators move, mm. With `slack`, a grip slides without damage,
    /// whichever actuator pulls the two bodies apart.
    pub fn allowed(&self, moved: u8, slack: bool) -> f64 {
        let Some((deeper_mm, by)) = &self.deeper else {
            return self.depth_mm;
        };
        let foreign = moved & self.by & !by != 0;
        // With `slack` the grip slides without damage, whichever actuator pulls the two apart.
        if foreign && !slack {
            self.depth_mm
        } else {
            *deeper_mm
        }
    }
}

/// Returns the limits of a pair; `None` when no actuator moves them relative to each other, or the scene ignores
/// them.
pub fn pair_limits(scene: &Scene, bodies: &[Body], pair: (usize, usize)) -> Option<PairLimits> {
    let (a, b) = (&bodies[pair.0], &bodies[pair.1]);
    if a.moves == b.moves {
        return None;
    }
    let rule = scene
        .pair
        .iter()
        .rev()
        .find(|it| it.is_of(&a.name, &b.name));
    let touch_mm = scene.guard.touch_depth_mm;
    let (depth_mm, deeper) = match rule.map(|it| (it.rule, it)) {
        None | Some((Rule::Forbidden, _)) => (0.0, None),
        Some((Rule::Ignore, _)) => return None,
        Some((Rule::MayTouch, it)) if it.by.is_empty() => (it.depth_mm.unwrap_or(touch_mm), None),
        Some((Rule::MayTouch, it)) => {
            let by = mask(|n| it.by.iter().any(|own| own == ACTUATORS[n]));
            (touch_mm, Some((it.depth_mm.unwrap_or(touch_mm), by)))
        }
    };
    Some(PairLimits {
        pair,
        by: mask(|n| a.moves[n] != b.moves[n]),
        depth_mm,
        deeper,
    })
}

/// Returns the actuators for which `holds` returns true, bit n = actuator n.
pub fn mask(holds: impl Fn(usize) -> bool) -> u8 {
    let bits = (0..ACTUATORS.len()).filter(|n| holds(*n));
    bits.fold(0, |all, n| all | 1 << n)
}
