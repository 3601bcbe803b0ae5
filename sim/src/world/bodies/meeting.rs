//! What two bodies may do: nothing, or press into each other so deep and by certain actuators.

use super::body::Body;
use super::scene::{Rule, Scene};
use crate::world::posture::ACTUATORS;

/// What two bodies may do.
#[derive(Debug, Clone)]
pub struct Meeting {
    /// Places in the list of bodies.
    pub pair: (usize, usize),
    /// Actuators that move them against each other.
    by: [bool; 8],
    /// Depth that is no crash, mm, by whatever moves.
    depth_mm: f64,
    /// Depth that is no crash by these actuators, mm.
    deeper: Option<(f64, [bool; 8])>,
}

impl Meeting {
    /// Something that moved brings them against each other.
    pub fn is_moved(&self, moved: &[bool; 8]) -> bool {
        (0..ACTUATORS.len()).any(|n| self.by[n] && moved[n])
    }

    /// How deep they may be in each other while these actuators move, mm. `slack`: nothing pulls them apart but springs.
    pub fn allowed(&self, moved: &[bool; 8], slack: bool) -> f64 {
        let Some((deeper_mm, by)) = &self.deeper else {
            return self.depth_mm;
        };
        let foreign = (0..ACTUATORS.len()).any(|n| moved[n] && self.by[n] && !by[n]);
        // Springs alone pull a grip apart without harm: it slides.
        if foreign && !slack {
            self.depth_mm
        } else {
            *deeper_mm
        }
    }
}

/// What a pair may do; none where nothing moves them against each other, or where they run in each other.
pub fn meeting(scene: &Scene, bodies: &[Body], pair: (usize, usize)) -> Option<Meeting> {
    let (a, b) = (&bodies[pair.0], &bodies[pair.1]);
    if a.moves == b.moves {
        return None;
    }
    let rule = scene.pair.iter().find(|it| it.is_of(&a.name, &b.name));
    let touch_mm = scene.guard.touch_depth_mm;
    let (depth_mm, deeper) = match rule.map(|it| (it.rule, it)) {
        None | Some((Rule::Forbidden, _)) => (0.0, None),
        Some((Rule::Ignore, _)) => return None,
        Some((Rule::MayTouch, it)) if it.by.is_empty() => (it.depth_mm.unwrap_or(touch_mm), None),
        Some((Rule::MayTouch, it)) => {
            let by = ACTUATORS.map(|name| it.by.iter().any(|own| own == name));
            (touch_mm, Some((it.depth_mm.unwrap_or(touch_mm), by)))
        }
    };
    Some(Meeting {
        pair,
        by: std::array::from_fn(|n| a.moves[n] != b.moves[n]),
        depth_mm,
        deeper,
    })
}
