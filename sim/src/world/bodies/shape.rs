//! Solids of `parry3d` for the bodies of the scene and for the parts.

use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::{Pose, Rot3, Vector};
use parry3d_f64::shape::SharedShape;

use super::scene::{Body, Form, Size};

/// Margin of a bounding box, mm: far more than its rounding error.
const MARGIN_MM: f64 = 1e-6;

/// A convex solid at rest.
#[derive(Clone)]
pub struct Solid {
    /// Shape.
    pub shape: SharedShape,
    rest: Pose,
    rest_box: Aabb,
}

impl std::fmt::Debug for Solid {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Solid at {:?}", self.rest.translation)
    }
}

impl Solid {
    fn new(shape: SharedShape, rest: Pose) -> Self {
        let rest_box = shape.compute_aabb(&rest);
        Self {
            shape,
            rest,
            rest_box,
        }
    }

    /// Returns the bounding box at rest.
    pub fn rest_box(&self) -> Aabb {
        self.rest_box
    }

    /// Returns the bounding box after the displacement `way`, larger by [`MARGIN_MM`] on every side.
    pub fn box_at(&self, way: Vector) -> Aabb {
        let margin = Vector::splat(MARGIN_MM);
        Aabb::new(
            self.rest_box.mins + way - margin,
            self.rest_box.maxs + way + margin,
        )
    }

    /// Returns the pose after the displacement `way`.
    pub fn placed(&self, way: Vector) -> Pose {
        Pose::from_parts(self.rest.translation + way, self.rest.rotation)
    }
}

/// Builds the convex solids of a body.
pub fn solids(body: &Body, at: &Pose) -> Vec<Solid> {
    let [x, y, z] = body.pose.position;
    let own = Pose::from_parts(Vector::new(x, y, z), turn(body.pose.rotation));
    let here = *at * own;
    match &body.form {
        Form::Block { half: [x, y, z] } => vec![Solid::new(SharedShape::cuboid(*x, *y, *z), here)],
        Form::Cylinder { radius, height } => {
            // `parry3d` aligns a cylinder with y; rotate it to z.
            let half_turn = std::f64::consts::FRAC_1_SQRT_2;
            let up = Rot3::from_xyzw(half_turn, 0.0, 0.0, half_turn).normalize();
            let turned = here * Pose::from_parts(Vector::ZERO, up);
            vec![Solid::new(
                SharedShape::cylinder(height / 2.0, *radius),
                turned,
            )]
        }
        Form::Compound { parts } => parts.iter().flat_map(|part| solids(part, &here)).collect(),
    }
}

/// Builds a part with the middle of its lower rear edge at `place`, displaced by `more`.
pub fn part(size: &Size, inset_mm: f64, place: [f64; 3], more: Vector) -> Vec<Solid> {
    let [length, width, height] = size.body_mm;
    let [x, y, z] = place;
    let block = |half: [f64; 3], middle_z: f64| {
        let centre = Vector::new(x + length / 2.0, y, z + middle_z) + more;
        let [hx, hy, hz] = half;
        Solid::new(
            SharedShape::cuboid(hx, hy, hz),
            Pose::from_parts(centre, Rot3::IDENTITY),
        )
    };
    let pins = size.pin_length_mm / 2.0;
    vec![
        block([length / 2.0, width / 2.0, height / 2.0], height / 2.0),
        block(
            [length / 2.0 - inset_mm, width / 2.0 - inset_mm, pins],
            -pins,
        ),
    ]
}

/// Converts a rotation, given as a quaternion with w first.
fn turn([w, x, y, z]: [f64; 4]) -> Rot3 {
    Rot3::from_xyzw(x, y, z, w).normalize()
}
