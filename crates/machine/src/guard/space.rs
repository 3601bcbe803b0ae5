//! The room that every body may occupy now, as elements of the collision core.
//!
//! Fixed elements enter the model once. Tooling and parts are replaced one by one, only when their possible positions
//! change.

use super::occupancy::{Offsets, room};
use super::part::{Role, shape_of};
use super::scene::Scene;
use super::situation::{PartSize, Situation};
use lpm::{ElementKey, Flaw, Model, Pose, Shape};

/// Inputs from which a body's room is computed; equal stamps mean equal rooms.
type Stamp = (Offsets, Option<PartSize>);

#[derive(Debug, Clone)]
struct Occupant {
    key: ElementKey,
    stamp: Stamp,
}

/// Roles of the part that are present, by [`Role::index`].
pub(super) type PresentRoles = [bool; 5];

#[derive(Debug, Clone)]
pub(super) struct Space {
    model: Model,
    occupants: Vec<Option<Occupant>>,
}

impl Space {
    /// Makes a space with the fixed elements only; the first situation adds tooling and parts.
    pub fn of(scene: &Scene) -> Result<Space, Flaw> {
        let mut space = Space {
            model: Model::new(),
            occupants: vec![None; scene.count()],
        };
        for (number, body) in scene.bodies.iter().enumerate() {
            if body.rides.is_empty() {
                space.put(
                    number,
                    &body.id,
                    &body.shape,
                    &body.pose,
                    (Offsets::NONE, None),
                )?;
            }
        }
        Ok(space)
    }

    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Yields every body in the space with its key.
    pub fn occupants(&self) -> impl Iterator<Item = (usize, ElementKey)> + '_ {
        let numbered = self.occupants.iter().enumerate();
        numbered.filter_map(|(number, occupant)| occupant.as_ref().map(|o| (number, o.key)))
    }

    /// Returns the number of the body with this key; `None` when no body has the key.
    pub fn number_of(&self, key: ElementKey) -> Option<usize> {
        self.occupants()
            .find(|(_, known)| *known == key)
            .map(|(number, _)| number)
    }

    /// Moves tooling and the parts that are `present` to their positions in `situation`.
    pub fn follow(
        &mut self,
        scene: &Scene,
        situation: &Situation,
        present: &PresentRoles,
    ) -> Result<(), Flaw> {
        for (number, body) in scene
            .bodies
            .iter()
            .enumerate()
            .filter(|(_, body)| !body.rides.is_empty())
        {
            let stamp = (scene.offsets(&body.rides, situation, None), None);
            self.put(number, &body.id, &body.shape, &body.pose, stamp)?;
        }
        for role in Role::ALL {
            let number = scene.number_of(role);
            if !present[role.index()] {
                self.take_out(number);
                continue;
            }
            let stamp = (
                part_offsets(scene, role, situation),
                Some(situation.part_size),
            );
            if !self.is_current(number, &stamp) {
                let shape = shape_of(&situation.part_size, &scene.policy);
                self.put(number, role.id(), &shape, &scene.part_pose(role), stamp)?;
            }
        }
        Ok(())
    }

    fn is_current(&self, number: usize, stamp: &Stamp) -> bool {
        self.occupants[number]
            .as_ref()
            .is_some_and(|occupant| occupant.stamp == *stamp)
    }

    fn put(
        &mut self,
        number: usize,
        id: &str,
        shape: &Shape,
        pose: &Pose,
        stamp: Stamp,
    ) -> Result<(), Flaw> {
        if self.is_current(number, &stamp) {
            return Ok(());
        }
        self.take_out(number);
        let (shape, pose) = room(shape, pose, &stamp.0);
        let key = self.model.insert(id, &shape, &pose)?;
        self.occupants[number] = Some(Occupant { key, stamp });
        Ok(())
    }

    fn take_out(&mut self, number: usize) {
        if let Some(occupant) = self.occupants[number].take() {
            self.model.remove(occupant.key);
        }
    }
}

/// Returns the offsets of a part; a released one may be anywhere from the magazine's mouth to the pocket.
fn part_offsets(scene: &Scene, role: Role, situation: &Situation) -> Offsets {
    match role {
        Role::Feed => Offsets::along(scene.feed_way(), 0.0, 1.0),
        Role::Pocket | Role::Pusher | Role::Nest | Role::Gripper => {
            scene.offsets(scene.rides(scene.number_of(role)), situation, None)
        }
    }
}
