//! Permissions of pairs: what a mover may do to each element, and where a move first violates a permission.
//!
//! For a pair of mover and element, coming within a margin is forbidden, or touching is allowed, or the check ignores
//! the pair. A question takes one margin for all elements, so this module asks once for all elements with equal
//! permissions, and the earliest violation counts. Bodies that may touch may also press into each other, up to a depth.
//! To check that, the caller takes this depth off the faces of the mover; the remaining contacts are exactly those that
//! go deeper.

use std::borrow::Cow;

use super::answer::{Answer, Contact, ElementKey, Move};
use super::model::Model;
use super::mover::Mover;
use super::pose::Pose;
use super::shape::{Flaw, Shape};

/// Least half extent of a piece of a mover, mm, that remains when [`Shape::less`] takes a depth off a thin piece.
const CORE_MM: f64 = 1e-3;

/// Distance beyond the margin up to which the distance of a forbidden pair is still measured, mm.
const MEASURED_BEYOND_MM: f64 = 1.0;

/// What a mover may do to an element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Permission {
    /// The distance must stay above the margin.
    Forbidden {
        /// Distance that must be exceeded, mm.
        margin_mm: f64,
    },
    /// The mover may touch the element and press into it by less than the depth.
    MayTouch {
        /// Depth taken off every face of the mover, mm, >= 0.
        depth_mm: f64,
    },
    /// The pair is not tested.
    Ignored,
}

impl Permission {
    /// Returns the margin and depth, mm; `None` for an ignored pair.
    fn asked_mm(self) -> Option<(f64, f64)> {
        match self {
            Permission::Forbidden { margin_mm } => Some((margin_mm, 0.0)),
            Permission::MayTouch { depth_mm } => Some((0.0, depth_mm)),
            Permission::Ignored => None,
        }
    }
}

/// A mover and its move.
#[derive(Debug, Clone)]
pub struct Passing<'a> {
    /// The mover, with the depth taken off its faces.
    pub mover: Cow<'a, Mover>,
    /// Pose at the start.
    pub from: Pose,
    /// Pose at the end.
    pub to: Pose,
}

/// First violation of a permission on a move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Forbidden {
    /// Contact with the element whose permission is violated.
    pub contact: Contact,
    /// Least distance of mover and element over the whole move, mm; at most 1 mm above the margin.
    pub distance_mm: f64,
    /// Violated margin, mm; 0 for a pair that may touch.
    pub margin_mm: f64,
}

impl Model {
    /// Returns the first violation of a permission on a move; `None` is proof that the move is allowed.
    ///
    /// An element that `permissions` omits must not be touched. `passing` gets a depth (mm) and returns the move with a
    /// mover thinned by this depth ([`Shape::less`]). The model calls `passing` once for each distinct permission, even
    /// when the depth is the same.
    ///
    /// # Errors
    /// Fails as `passing` does.
    pub fn first_forbidden<'a>(
        &self,
        permissions: &[(ElementKey, Permission)],
        mut passing: impl FnMut(f64) -> Result<Passing<'a>, Flaw>,
    ) -> Result<Option<Forbidden>, Flaw> {
        let pairs = self.all_pairs(permissions);
        let mut first: Option<Forbidden> = None;
        for (number, (_, permission)) in pairs.iter().enumerate() {
            let is_known = pairs[..number].iter().any(|pair| pair.1 == *permission);
            let asked = permission.asked_mm().filter(|_| !is_known);
            let Some((margin_mm, depth_mm)) = asked else {
                continue;
            };
            let others = pairs.iter().filter(|pair| pair.1 != *permission);
            let ignore: Vec<ElementKey> = others.map(|pair| pair.0).collect();
            let found = self.forbidden(&passing(depth_mm)?, margin_mm, &ignore);
            first = match (first, found) {
                (Some(a), Some(b)) if a.contact.t_stop <= b.contact.t_stop => Some(a),
                (known, None) => known,
                (_, found) => found,
            };
        }
        Ok(first)
    }

    /// Returns the permissions, with [`Permission::Forbidden`] and margin 0 added for each element that they omit.
    fn all_pairs(&self, permissions: &[(ElementKey, Permission)]) -> Vec<(ElementKey, Permission)> {
        let mut pairs = permissions.to_vec();
        pairs.sort_by_key(|pair| pair.0);
        let is_named = |key: &ElementKey| pairs.binary_search_by_key(key, |pair| pair.0).is_ok();
        let unnamed: Vec<ElementKey> = self.keys().filter(|key| !is_named(key)).collect();
        let touching = Permission::Forbidden { margin_mm: 0.0 };
        pairs.extend(unnamed.into_iter().map(|key| (key, touching)));
        pairs
    }

    fn forbidden(
        &self,
        passing: &Passing,
        margin_mm: f64,
        ignore: &[ElementKey],
    ) -> Option<Forbidden> {
        let way = |ignore| Move {
            from: passing.from,
            to: passing.to,
            margin_mm,
            ignore,
        };
        let contact = match self.first_contact(&*passing.mover, &way(ignore)) {
            Answer::Clear => return None,
            Answer::Blocked(contact) => contact,
        };
        let others = self.keys().filter(|key| *key != contact.blocker);
        let others: Vec<ElementKey> = others.collect();
        let range_mm = margin_mm + MEASURED_BEYOND_MM;
        let least = self.clearance(&*passing.mover, &way(&others), range_mm);
        Some(Forbidden {
            contact,
            distance_mm: least.map_or(contact.distance_mm, |least| least.distance_mm),
            margin_mm,
        })
    }
}

impl Shape {
    /// Returns the shape with `depth_mm` taken off every face of every block and cylinder, down to a thin core; meshes
    /// stay whole.
    pub fn less(&self, depth_mm: f64) -> Shape {
        let less = |half: f64| (half - depth_mm).max(CORE_MM.min(half));
        match self {
            Shape::Block { half } => Shape::Block {
                half: half.map(less),
            },
            Shape::Cylinder { radius, height } => Shape::Cylinder {
                radius: less(*radius),
                height: 2.0 * less(height / 2.0),
            },
            Shape::Compound(parts) => {
                let parts = parts
                    .iter()
                    .map(|(pose, part)| (*pose, part.less(depth_mm)));
                Shape::Compound(parts.collect())
            }
            Shape::Mesh(_) => self.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    const CUBE: Shape = Shape::Block { half: [1.0; 3] };

    /// Asks about a cube that goes from x = 0 to 10 towards a wall with its face at x = 5: they meet after 0.4 of the
    /// move.
    fn asked(permission: Option<Permission>) -> Option<Forbidden> {
        let mut model = Model::new();
        let wall = Shape::Block {
            half: [1.0, 5.0, 5.0],
        };
        let key = model
            .insert("wall", &wall, &Pose::at([6.0, 0.0, 0.0]))
            .unwrap();
        let permissions: Vec<_> = permission.map(|it| (key, it)).into_iter().collect();
        let found = model.first_forbidden(&permissions, |depth_mm| {
            Ok(Passing {
                mover: Cow::Owned(Mover::new(&CUBE.less(depth_mm))?),
                from: Pose::IDENTITY,
                to: Pose::at([10.0, 0.0, 0.0]),
            })
        });
        found.unwrap()
    }

    fn stop(permission: Option<Permission>) -> Option<f64> {
        asked(permission).map(|found| found.contact.t_stop)
    }

    #[test]
    fn forbidden_pairs_stop_at_margin_others_at_depth() {
        let near = |found: Option<f64>, wanted: f64| {
            let found = found.unwrap();
            assert!(found <= wanted && wanted - found < 1e-9, "{found} {wanted}");
        };
        near(stop(Some(Permission::Forbidden { margin_mm: 0.5 })), 0.35);
        near(stop(Some(Permission::Forbidden { margin_mm: 0.0 })), 0.4);
        near(stop(Some(Permission::MayTouch { depth_mm: 0.25 })), 0.425);
        assert_eq!(stop(Some(Permission::Ignored)), None);
        near(stop(None), 0.4);
    }

    #[test]
    fn a_forbidden_pair_is_measured_over_the_whole_way() {
        let found = asked(Some(Permission::Forbidden { margin_mm: 0.5 })).unwrap();
        assert_eq!((found.distance_mm, found.margin_mm), (0.0, 0.5));
    }

    #[test]
    fn the_permission_violated_first_is_reported() {
        let mut model = Model::new();
        let mut stand = |x: f64| {
            model
                .insert("cube", &CUBE, &Pose::at([x, 0.0, 0.0]))
                .unwrap()
        };
        let (near, middle, far) = (stand(4.0), stand(7.0), stand(10.0));
        let passing = |depth_mm: f64| {
            Ok(Passing {
                mover: Cow::Owned(Mover::new(&CUBE.less(depth_mm))?),
                from: Pose::IDENTITY,
                to: Pose::at([20.0, 0.0, 0.0]),
            })
        };
        let told = |of_near, of_middle| {
            let far = (far, Permission::Forbidden { margin_mm: 0.0 });
            let permissions = [far, (middle, of_middle), (near, of_near)];
            let found = model.first_forbidden(&permissions, passing).unwrap();
            found.unwrap().contact.blocker
        };
        let deep = Permission::MayTouch { depth_mm: 0.5 };
        let apart = Permission::Forbidden { margin_mm: 1.0 };
        assert_eq!(told(deep, apart), near);
        assert_eq!(told(Permission::Ignored, apart), middle);
        assert_eq!(told(Permission::Ignored, Permission::Ignored), far);
    }

    #[test]
    fn a_body_that_may_touch_never_vanishes() {
        let foil = Shape::Block {
            half: [5.0, 5.0, 0.1],
        };
        assert_eq!(
            foil.less(0.25),
            Shape::Block {
                half: [4.75, 4.75, CORE_MM]
            }
        );
        let pin = Shape::Cylinder {
            radius: 0.3,
            height: 8.0,
        };
        assert_eq!(
            pin.less(0.25),
            Shape::Cylinder {
                radius: 0.3 - 0.25,
                height: 7.5
            }
        );
    }
}
