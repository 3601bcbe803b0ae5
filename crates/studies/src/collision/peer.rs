//! The collision library parry3d in single and double precision, queried with one shape cast per move.
//!
//! Scene and mover are one compound each. A move of length zero uses an intersection test, because the shape cast
//! reports no contact for it. The axis of a parry3d cylinder is y: this module rotates it to z.

/// Defines a module with a `Peer` for one precision of parry3d.
macro_rules! peer {
    ($name:ident, $library:ident, $real:ty) => {
        pub mod $name {
            use super::super::world::{TestMove, UNIT_MM};
            use lpm::exact::{Body, Form};
            use $library::math::{Pose, Rot3, Vector};
            use $library::query::{ShapeCastOptions, cast_shapes, intersection_test};
            use $library::shape::{Compound, SharedShape};

            /// Scene and mover as compound shapes of parry3d.
            pub struct Peer {
                scene: Compound,
                mover: Compound,
            }

            impl Peer {
                /// Builds the compounds of scene and mover.
                pub fn new(elements: &[Body], parts: &[Body]) -> Peer {
                    let compound =
                        |bodies: &[Body]| Compound::new(bodies.iter().map(placed).collect());
                    Peer {
                        scene: compound(elements),
                        mover: compound(parts),
                    }
                }

                /// Returns the time of impact as a fraction of the move; `None` for a clear move.
                pub fn first_contact(&self, test_move: &TestMove) -> Option<f64> {
                    let from = Pose::from_parts(vector(test_move.from), Rot3::IDENTITY);
                    let (here, still, run) = (Pose::IDENTITY, Vector::ZERO, vector(test_move.run));
                    if run == still {
                        let met = intersection_test(&here, &self.scene, &from, &self.mover);
                        return met.is_ok_and(|it| it.intersecting).then_some(0.0);
                    }
                    let options = ShapeCastOptions {
                        compute_impact_geometry_on_penetration: false,
                        ..ShapeCastOptions::with_max_time_of_impact(1.0)
                    };
                    let hit =
                        cast_shapes(&here, still, &self.scene, &from, run, &self.mover, options);
                    hit.ok().flatten().map(|it| it.time_of_impact as f64)
                }
            }

            fn mm(units: i64) -> $real {
                (units as f64 * UNIT_MM) as $real
            }

            fn vector(units: [i64; 3]) -> Vector {
                Vector::new(mm(units[0]), mm(units[1]), mm(units[2]))
            }

            fn placed(body: &Body) -> (Pose, SharedShape) {
                let upright = std::f64::consts::FRAC_1_SQRT_2 as $real;
                let (turn, shape) = match body.form {
                    Form::Block {
                        half: [x, y, z],
                        rotation,
                    } => {
                        let [w, i, j, k] = rotation.map(|it| it as $real);
                        (
                            Rot3::from_xyzw(i, j, k, w).normalize(),
                            SharedShape::cuboid(mm(x), mm(y), mm(z)),
                        )
                    }
                    Form::Cylinder { radius, half } => (
                        Rot3::from_xyzw(upright, 0.0, 0.0, upright).normalize(),
                        SharedShape::cylinder(mm(half), mm(radius)),
                    ),
                    Form::Triangle([a, b, c]) => (
                        Rot3::IDENTITY,
                        SharedShape::triangle(vector(a), vector(b), vector(c)),
                    ),
                };
                (Pose::from_parts(vector(body.centre), turn), shape)
            }
        }
    };
}

peer!(double, parry3d_f64, f64);
peer!(single, parry3d, f32);
