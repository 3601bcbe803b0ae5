//! One body: its convex solids at rest, and its motion with each actuator.

use parry3d_f64::bounding_volume::{Aabb, BoundingVolume};
use parry3d_f64::math::{Pose, Vector};
use parry3d_f64::query::contact;

use super::scene::{Element, Scene, Size};
use super::shape::{self, Solid};
use crate::world::posture::{ACTUATORS, Posture};

const PUSHER: usize = 1;
const SORT_Z: usize = 5;
const SORT_AXIS: usize = 7;

/// Names of the bodies that stand for a part, one for each of its places; in the list of bodies they follow the
/// elements.
pub const PARTS: [&str; 4] = ["part_pocket", "part_pusher", "part_nest", "part_gripper"];

/// One body: its solids at rest and its motion.
#[derive(Debug, Clone)]
pub struct Body {
    /// Name in the scene.
    pub name: String,
    solids: Vec<Solid>,
    /// Displacement of the body per mm of travel, for each actuator.
    pub moves: [Vector; 8],
    rest_box: Aabb,
}

impl Body {
    fn new(name: String, solids: Vec<Solid>, moves: [Vector; 8]) -> Self {
        let boxes = solids.iter().map(Solid::rest_box);
        let rest_box = boxes
            .reduce(|all, one| all.merged(&one))
            .unwrap_or(Aabb::new_invalid());
        Self {
            name,
            solids,
            moves,
            rest_box,
        }
    }

    fn offset(&self, posture: &Posture) -> Vector {
        let ways = self.moves.iter().zip(posture.mm);
        ways.fold(Vector::ZERO, |sum, (per_mm, mm)| sum + *per_mm * mm)
    }

    /// Returns a box that encloses the body on its whole way between two postures.
    pub fn swept(&self, from: &Posture, to: &Posture) -> Aabb {
        let at = |posture| {
            let way = self.offset(posture);
            Aabb::new(self.rest_box.mins + way, self.rest_box.maxs + way)
        };
        at(from).merged(&at(to))
    }
}

/// Returns the depth to which two bodies penetrate each other in a posture, mm; negative infinity when they are apart.
pub fn depth_mm(a: &Body, b: &Body, posture: &Posture) -> f64 {
    let (way_a, way_b) = (a.offset(posture), b.offset(posture));
    let mut depth = f64::NEG_INFINITY;
    for one in &a.solids {
        for other in &b.solids {
            if !one.box_at(way_a).intersects(&other.box_at(way_b)) {
                continue;
            }
            let (here, there) = (one.placed(way_a), other.placed(way_b));
            let met = contact(&here, &*one.shape, &there, &*other.shape, 0.0);
            if let Ok(Some(met)) = met {
                depth = depth.max(-met.dist);
            }
        }
    }
    depth
}

/// Builds an element that moves with its own actuator and with those that carry that actuator.
pub fn element(scene: &Scene, element: &Element) -> Body {
    let mut moves = [Vector::ZERO; 8];
    let mut rides = element.rides.as_deref();
    while let Some(name) = rides {
        let Some(own) = scene.actuator.iter().find(|it| it.id == name) else {
            break;
        };
        let [x, y, z] = own.axis;
        let back = own.opposed.contains(&element.id);
        if let Some(n) = ACTUATORS.iter().position(|it| *it == name) {
            moves[n] = Vector::new(x, y, z) * if back { -1.0 } else { 1.0 };
        }
        rides = own.rides.as_deref();
    }
    let solids = shape::solids(&element.body, &Pose::IDENTITY);
    Body::new(element.id.clone(), solids, moves)
}

/// Builds a part in each of its places. The part in the gripper coincides with that in the nest while sort z is down
/// and the axis at the nest, where the fingers grip it.
pub fn parts(scene: &Scene, size: &Size) -> Vec<Body> {
    let places = &scene.guard;
    let lowered = Vector::new(0.0, 0.0, scene.stroke_mm(ACTUATORS[SORT_Z]));
    let at = |place: [f64; 3], more: Vector, moves: [Vector; 8], name: &str| {
        let solids = shape::part(size, places.pin_inset_mm, place, more);
        Body::new(name.to_owned(), solids, moves)
    };
    let still = [Vector::ZERO; 8];
    let mut pushed = still;
    pushed[PUSHER] = Vector::new(1.0, 0.0, 0.0);
    let mut held = still;
    held[SORT_Z] = Vector::new(0.0, 0.0, -1.0);
    held[SORT_AXIS] = Vector::new(1.0, 0.0, 0.0);
    vec![
        at(places.pocket, Vector::ZERO, still, PARTS[0]),
        at(places.pocket, Vector::ZERO, pushed, PARTS[1]),
        at(places.nest, Vector::ZERO, still, PARTS[2]),
        at(places.nest, lowered, held, PARTS[3]),
    ]
}
