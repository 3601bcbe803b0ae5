//! The scene as a drawing: silhouettes of every body, and the actuators that carry it.

use super::part::{Role, shape_of};
use super::scene::Ride;
use super::{Actuator, Guard, PartSize};
use lpm::{Pose, Shape, View, outlines};

/// A body in its place, with all actuators at rest.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawn {
    /// Id in the scene; for a part `part_pocket`, `part_pusher`, `part_nest` or `part_gripper`.
    pub id: String,
    /// Actuators that carry the body, each with the body's displacement per millimetre of stroke, mm.
    pub rides: Vec<(Actuator, [f64; 3])>,
    /// Silhouettes from above, x and y in mm.
    pub above: Vec<Vec<[f64; 2]>>,
    /// Silhouettes from the front, x and z in mm.
    pub front: Vec<Vec<[f64; 2]>>,
}

impl Guard {
    /// Returns every body of the scene, then a part of this size in each of its places.
    #[must_use]
    pub fn drawing(&self, size: &PartSize) -> Vec<Drawn> {
        let bodies = self.scene.bodies.iter();
        let bodies = bodies.map(|body| drawn(&body.id, &body.shape, body.pose, &body.rides));
        let part = shape_of(size, &self.scene.policy);
        let roles = Role::ALL.into_iter().filter(|role| *role != Role::Feed);
        let parts = roles.map(|role| {
            let rides = &self.scene.part_rides[role.index()];
            drawn(role.id(), &part, self.scene.part_pose(role), rides)
        });
        bodies.chain(parts).collect()
    }
}

fn drawn(id: &str, shape: &Shape, pose: Pose, rides: &[Ride]) -> Drawn {
    Drawn {
        id: id.to_owned(),
        rides: rides.iter().map(|it| (it.actuator, it.direction)).collect(),
        above: outlines(shape, pose, View::Above),
        front: outlines(shape, pose, View::Front),
    }
}
