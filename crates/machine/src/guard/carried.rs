//! The bodies that a stroke carries along, and the parts in the space during it.
//!
//! - A part in the pocket counts as in front of the pusher once the pusher has begun to move, or may have.
//! - The pusher carries the part in front of it forward. Going back it leaves the part where it is: the part remains
//!   an obstacle for all other bodies, but the pusher cannot hit the part that it leaves.
//! - The gripper takes its part wherever its carriers go. A closed gripper that is down at the nest takes the part in
//!   the nest along, even if the ledger places it in the nest.
//! - A released escapement lets a part run from the magazine's mouth into the pocket. Until it holds again a part may
//!   be anywhere between the two.
//! - Bodies on the same moving actuator are one tool and are not tested against each other.

use super::actuator::Actuator;
use super::motion::Stroke;
use super::part::Role;
use super::scene::Scene;
use super::situation::Situation;
use super::space::PresentRoles;

/// The roles of the parts during one stroke: a role is a place of a part that has its own body in the scene.
#[derive(Debug, Clone, Copy)]
pub(super) struct PartRoles {
    /// Roles present in the space.
    pub present: PresentRoles,
    /// Role that moves with the stroke, if a part does.
    pub taken: Option<Role>,
    /// Role that the stroke leaves behind, if it leaves a part.
    pub left: Option<Role>,
}

/// Assigns the parts of `situation` to roles for `stroke`.
pub(super) fn part_roles(scene: &Scene, situation: &Situation, stroke: &Stroke) -> PartRoles {
    let parts = situation.parts;
    let released = scene.span_mm(Actuator::Escapement, situation).1 > 0.0;
    let pusher = scene.span_mm(Actuator::Pusher, situation);
    let mut part_roles = PartRoles {
        present: [
            released,
            parts.pocket,
            parts.on_pusher,
            parts.nest,
            parts.gripper,
        ],
        taken: None,
        left: None,
    };
    if pusher.0 <= 0.0 && (pusher.1 > 0.0 || stroke.actuator == Actuator::Pusher) {
        part_roles.put_before_pusher();
    }
    match stroke.actuator {
        Actuator::Escapement => part_roles.feeding(stroke.to_mm > 0.0),
        Actuator::Pusher => part_roles.pushing(stroke.to_mm > pusher.0),
        Actuator::SortAxis | Actuator::SortZ => {
            part_roles.carrying(holds_nest_part(scene, situation))
        }
        Actuator::JawLeft | Actuator::JawRight | Actuator::ProbeLift | Actuator::Gripper => {}
    }
    part_roles
}

impl PartRoles {
    fn has(&self, role: Role) -> bool {
        self.present[role.index()]
    }

    /// Moves the part in role `from` to role `to` for this stroke.
    fn recast(&mut self, from: Role, to: Role) {
        self.present[from.index()] = false;
        self.present[to.index()] = true;
    }

    fn feeding(&mut self, releasing: bool) {
        if releasing {
            self.present[Role::Feed.index()] = true;
            self.taken = Some(Role::Feed);
        }
    }

    /// Moves the pocket's part to the role in front of the pusher, for a pusher that may have left its rest end.
    fn put_before_pusher(&mut self) {
        if self.has(Role::Pocket) && !self.has(Role::Pusher) {
            self.recast(Role::Pocket, Role::Pusher);
        }
    }

    fn pushing(&mut self, forward: bool) {
        let before = self.has(Role::Pusher).then_some(Role::Pusher);
        if forward {
            self.taken = before;
        } else {
            self.left = before;
        }
    }

    fn carrying(&mut self, holds_nest_part: bool) {
        if holds_nest_part && self.has(Role::Nest) && !self.has(Role::Gripper) {
            self.recast(Role::Nest, Role::Gripper);
        }
        self.taken = self.has(Role::Gripper).then_some(Role::Gripper);
    }
}

/// Returns true when the gripper is closed and fully down at the nest.
fn holds_nest_part(scene: &Scene, situation: &Situation) -> bool {
    let axis = scene.span_mm(Actuator::SortAxis, situation);
    let down = scene.span_mm(Actuator::SortZ, situation);
    let closed = scene.span_mm(Actuator::Gripper, situation);
    let bottom = scene.axis(Actuator::SortZ).stroke_mm.1;
    closed.0 > 0.0 && down == (bottom, bottom) && axis == (0.0, 0.0)
}
