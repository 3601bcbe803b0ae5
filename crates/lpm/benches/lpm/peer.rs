//! The peers: parry3d in single and in double precision, each used in the ways that its interface offers.
//!
//! `compound`: scene and mover are one `Compound` each, and a question is one call. `pairs`: each part of the mover is
//! tested against the raw `Bvh`, and the pairs found go through `cast_shapes` or `intersection_test`; unlike the call
//! on compounds, this can stop at the first hit. Cylinders lie along the native axis of the library (y), its best case.

/// Defines a module for one precision of the library.
macro_rules! peer {
    ($name:ident, $library:ident, $real:ty) => {
        pub mod $name {
            use crate::timing::Rounds;
            use lpm;
            use $library::bounding_volume::{Aabb, BoundingVolume};
            use $library::math::{Pose, Rot3, Vector};
            use $library::partitioning::{Bvh, BvhBuildStrategy, BvhNode};
            use $library::query::{
                Ray, RayCast, ShapeCastHit, ShapeCastOptions, cast_shapes, intersection_test,
            };
            use $library::shape::{Compound, SharedShape};

            /// A shape of parry3d with its pose.
            pub type Placed = (Pose, SharedShape);

            pub struct Peer {
                scene: Compound,
                mover: Compound,
            }

            fn vector(v: [f64; 3]) -> Vector {
                Vector::new(v[0] as $real, v[1] as $real, v[2] as $real)
            }

            fn pose(pose: &lpm::Pose) -> Pose {
                let [w, x, y, z] = pose.rotation.map(|member| member as $real);
                let rotation = Rot3::from_xyzw(x, y, z, w).normalize();
                Pose::from_parts(vector(pose.position), rotation)
            }

            /// Converts a body; turns a cylinder from y to z by a quarter turn about x.
            fn placed((shape, place): &(lpm::Shape, lpm::Pose)) -> Placed {
                let place = pose(place);
                match shape {
                    lpm::Shape::Block { half: [x, y, z] } => (
                        place,
                        SharedShape::cuboid(*x as $real, *y as $real, *z as $real),
                    ),
                    lpm::Shape::Cylinder { radius, height } => {
                        let half = std::f64::consts::FRAC_1_SQRT_2 as $real;
                        let upright = Rot3::from_xyzw(half, 0.0, 0.0, half).normalize();
                        let turned = Pose::from_parts(place.translation, place.rotation * upright);
                        (
                            turned,
                            SharedShape::cylinder((*height / 2.0) as $real, *radius as $real),
                        )
                    }
                    other => unreachable!("not in these scenes: {other:?}"),
                }
            }

            impl Peer {
                pub fn new(
                    elements: &[(lpm::Shape, lpm::Pose)],
                    mover: &[(lpm::Shape, lpm::Pose)],
                ) -> Peer {
                    Peer {
                        scene: Compound::new(elements.iter().map(placed).collect()),
                        mover: Compound::new(mover.iter().map(placed).collect()),
                    }
                }

                /// Prepares shared shapes before the measurement.
                pub fn bodies(elements: &[(lpm::Shape, lpm::Pose)]) -> Vec<Placed> {
                    elements.iter().map(placed).collect()
                }

                /// Builds the whole compound.
                pub fn build(bodies: &[Placed], rounds: &mut Rounds) {
                    rounds.turn(|| bodies.to_vec(), Self::built);
                }

                pub fn built(bodies: Vec<Placed>) -> Compound {
                    Compound::new(bodies)
                }

                /// Returns a function that inserts one leaf into the raw tree and removes the leaf; the bounds of the
                /// leaf are computed in advance.
                pub fn editor(&self) -> impl FnMut(&usize) {
                    let bounds = self.scene.aabbs();
                    let spare = bounds.len() as u32;
                    let mut tree = Bvh::from_leaves(BvhBuildStrategy::Binned, bounds);
                    move |index| {
                        tree.insert(bounds[*index], spare);
                        tree.remove(spare);
                    }
                }

                /// Returns the time of first contact, by one call; bodies that overlap at the start give 0.
                pub fn compound(&self, way: &lpm::Move) -> Option<f64> {
                    let (from, run) = (pose(&way.from), run(way));
                    if run == Vector::ZERO {
                        let met =
                            intersection_test(&Pose::IDENTITY, &self.scene, &from, &self.mover);
                        return met.is_ok_and(|met| met.intersecting).then_some(0.0);
                    }
                    let hit = cast_shapes(
                        &Pose::IDENTITY,
                        Vector::ZERO,
                        &self.scene,
                        &from,
                        run,
                        &self.mover,
                        options(1.0),
                    );
                    hit.ok().flatten().map(|hit| hit.time_of_impact as f64)
                }

                /// Returns the time of first contact, part by part over the raw tree.
                pub fn pairs_first(&self, way: &lpm::Move) -> Option<f64> {
                    let (from, run) = (pose(&way.from), run(way));
                    if run == Vector::ZERO {
                        return self.pairs_any(way).then_some(0.0);
                    }
                    let mut least: $real = 1.0;
                    let mut found = None;
                    for (local, part) in self.mover.shapes() {
                        let at = from * *local;
                        let bounds = part.compute_aabb(&at);
                        let ray = Ray::new(Vector::ZERO, run);
                        let margin = Vector::splat(way.margin_mm as $real);
                        let (shift, half) = (-bounds.center(), bounds.half_extents() + margin);
                        let best = self.scene.bvh().find_best(
                            least,
                            |node: &BvhNode, best| {
                                let sum = Aabb {
                                    mins: node.mins() + shift - half,
                                    maxs: node.maxs() + shift + half,
                                };
                                sum.cast_local_ray(&ray, best, true).unwrap_or(<$real>::MAX)
                            },
                            |leaf, best| self.pair(leaf, &at, way, part, best),
                        );
                        if let Some((_, hit)) = best {
                            least = hit.time_of_impact;
                            found = Some(least as f64);
                        }
                    }
                    found
                }

                /// Returns true when there is a hit, part by part over the raw tree.
                pub fn pairs_any(&self, way: &lpm::Move) -> bool {
                    let (from, run) = (pose(&way.from), run(way));
                    let still = run == Vector::ZERO;
                    self.mover.shapes().iter().any(|(local, part)| {
                        let at = from * *local;
                        let bounds = part.compute_aabb(&at);
                        let ahead = Aabb {
                            mins: bounds.mins + run,
                            maxs: bounds.maxs + run,
                        };
                        let swept = bounds.merged(&ahead);
                        let mut leaves = self
                            .scene
                            .bvh()
                            .leaves(|node: &BvhNode| node.aabb().intersects(&swept));
                        leaves.any(|leaf| {
                            if still {
                                let (place, element) = &self.scene.shapes()[leaf as usize];
                                let met = intersection_test(place, &**element, &at, &**part);
                                return met.is_ok_and(|met| met.intersecting);
                            }
                            self.pair(leaf, &at, way, part, 1.0).is_some()
                        })
                    })
                }

                fn pair(
                    &self,
                    leaf: u32,
                    at: &Pose,
                    way: &lpm::Move,
                    part: &SharedShape,
                    best: $real,
                ) -> Option<ShapeCastHit> {
                    let (place, element) = &self.scene.shapes()[leaf as usize];
                    let hit = cast_shapes(
                        place,
                        Vector::ZERO,
                        &**element,
                        at,
                        run(way),
                        &**part,
                        ShapeCastOptions {
                            target_distance: way.margin_mm as $real,
                            ..options(best)
                        },
                    );
                    hit.ok().flatten()
                }
            }

            fn run(way: &lpm::Move) -> Vector {
                let (from, to) = (way.from.position, way.to.position);
                vector([to[0] - from[0], to[1] - from[1], to[2] - from[2]])
            }

            /// Returns shape-cast options for verdict and time only, without the geometry of the impact.
            fn options(until: $real) -> ShapeCastOptions {
                ShapeCastOptions {
                    max_time_of_impact: until,
                    compute_impact_geometry_on_penetration: false,
                    ..ShapeCastOptions::default()
                }
            }
        }
    };
}

peer!(double, parry3d_f64, f64);
peer!(single, parry3d, f32);
