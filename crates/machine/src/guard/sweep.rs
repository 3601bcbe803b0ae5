//! One stroke swept through the space.
//!
//! The guard sweeps every body that moves with the stroke, in its true shape, along the whole way, and tests it in the
//! collision core against the rooms of all other bodies. Where a mover also rides on an actuator of unknown position,
//! the guard sweeps the cover of the mover's room. So, for every combination of positions that the situation allows,
//! the real bodies lie inside the tested ones: a cleared stroke is clear for all of them.
//!
//! This module decides what the mover may do to each other body; the core applies it.

use super::carried::{PartRoles, part_roles};
use super::motion::Stroke;
use super::occupancy::{Offsets, room, scaled, sum};
use super::part::{Role, shape_of};
use super::scene::Scene;
use super::situation::Situation;
use super::space::Space;
use lpm::{ElementKey, Flaw, Forbidden, Move, Mover, Passing, Permission, Pose, Shape};
use std::borrow::Cow;

/// The first contact of a stroke.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FirstContact {
    pub stroke: Stroke,
    /// Number of the moving body. The next field is the number of the body in its way, `None` when the core could not
    /// decide.
    pub mover: usize,
    pub blocker: Option<usize>,
    pub distance_mm: f64,
    pub margin_mm: f64,
    pub at_fraction: f64,
    pub at: [f64; 3],
    /// Start of the sweep and position at which the margin is reached, mm; `None` when the start is unknown or within
    /// the margin.
    pub clear_way_mm: Option<(f64, f64)>,
}

struct Travel<'a> {
    number: usize,
    shape: Cow<'a, Shape>,
    /// The shape decomposed in advance; `None` when other actuators leave the body's offset uncertain.
    ready: Option<&'a Mover>,
    pose: Pose,
    /// Offsets of the body that the uncertain positions of other actuators allow.
    unsure: Offsets,
    from: [f64; 3],
    to: [f64; 3],
}

/// Sweeps `stroke` from the position in `situation`; `Ok(None)` proves that it is clear.
pub(super) fn sweep(
    scene: &Scene,
    space: &mut Space,
    situation: &Situation,
    stroke: &Stroke,
) -> Result<Option<FirstContact>, Flaw> {
    let part_roles = part_roles(scene, situation, stroke);
    space.follow(scene, situation, &part_roles.present)?;
    let span = scene.span_mm(stroke.actuator, situation);
    let way = way(span, stroke.to_mm);
    let travels = travels(scene, situation, stroke, &part_roles, way);
    let moving: Vec<usize> = travels.iter().map(|travel| travel.number).collect();
    let mut first: Option<(usize, Forbidden)> = None;
    for travel in &travels {
        let permissions = permissions(scene, space, stroke, travel, &moving, &part_roles);
        let model = space.model();
        let found = model.first_forbidden(&permissions, |depth_mm| travel.passing(depth_mm))?;
        if let Some(found) = found
            && first.is_none_or(|(_, known)| found.contact.t_stop < known.contact.t_stop)
        {
            first = Some((travel.number, found));
        }
    }
    Ok(first.map(|first| finding(space, stroke, span.0 == span.1, way, first)))
}

/// Returns the least distance of `stroke` to the bodies that it must not touch, mm; `None` beyond `range_mm`. Bodies
/// that the stroke may touch do not count.
pub(super) fn least_mm(
    scene: &Scene,
    space: &mut Space,
    situation: &Situation,
    stroke: &Stroke,
    range_mm: f64,
) -> Result<Option<f64>, Flaw> {
    let part_roles = part_roles(scene, situation, stroke);
    space.follow(scene, situation, &part_roles.present)?;
    let way = way(scene.span_mm(stroke.actuator, situation), stroke.to_mm);
    let travels = travels(scene, situation, stroke, &part_roles, way);
    let moving: Vec<usize> = travels.iter().map(|travel| travel.number).collect();
    let all = travels.iter().filter_map(|travel| {
        let permissions = permissions(scene, space, stroke, travel, &moving, &part_roles);
        let apart = |permission: &Permission| matches!(permission, Permission::Forbidden { .. });
        let ignore: Vec<ElementKey> = permissions
            .iter()
            .filter(|(_, permission)| !apart(permission))
            .map(|(key, _)| *key)
            .collect();
        let (shape, pose) = room(&travel.shape, &travel.pose, &travel.unsure);
        let way = Move {
            from: pose.moved_to(sum(pose.position, travel.from)),
            to: pose.moved_to(sum(pose.position, travel.to)),
            margin_mm: 0.0,
            ignore: &ignore,
        };
        let least = space.model().clearance(&*shape, &way, range_mm)?;
        Some(least.distance_mm)
    });
    Ok(all.min_by(f64::total_cmp))
}

/// Returns the way from that end of the span which is farther from the target to the target; the whole span when the
/// target lies in it.
fn way((low, high): (f64, f64), to_mm: f64) -> (f64, f64) {
    if to_mm >= high {
        (low, to_mm)
    } else if to_mm <= low {
        (high, to_mm)
    } else {
        (low, high)
    }
}

fn travels<'a>(
    scene: &'a Scene,
    situation: &Situation,
    stroke: &Stroke,
    part_roles: &PartRoles,
    way: (f64, f64),
) -> Vec<Travel<'a>> {
    let tooling = scene.bodies.iter().enumerate();
    let tooling = tooling.map(|(number, body)| (number, Cow::Borrowed(&body.shape), body.pose));
    let part = part_roles.taken.map(|role| {
        let shape = shape_of(&situation.part_size, &scene.policy);
        (
            scene.number_of(role),
            Cow::Owned(shape),
            scene.part_pose(role),
        )
    });
    let all = tooling.chain(part);
    all.filter_map(|(number, shape, pose)| {
        let rides = scene.rides(number);
        let (from, to) = match rides.iter().find(|ride| ride.actuator == stroke.actuator) {
            Some(ride) => (scaled(ride.direction, way.0), scaled(ride.direction, way.1)),
            None if number == scene.number_of(Role::Feed) => ([0.0; 3], scene.feed_way()),
            None => return None,
        };
        let unsure = scene.offsets(rides, situation, Some(stroke.actuator));
        Some(Travel {
            number,
            shape,
            ready: scene
                .bodies
                .get(number)
                .map(|body| &body.mover)
                .filter(|_| unsure.is_point()),
            pose,
            unsure,
            from,
            to,
        })
    })
    .collect()
}

/// Returns the permission of `travel` towards every body in the space; ignores those that move with it.
fn permissions(
    scene: &Scene,
    space: &Space,
    stroke: &Stroke,
    travel: &Travel<'_>,
    moving: &[usize],
    part_roles: &PartRoles,
) -> Vec<(ElementKey, Permission)> {
    let left = part_roles.left.map(|role| scene.number_of(role));
    let permission = |number: usize| {
        if moving.contains(&number) || left == Some(number) {
            return Permission::Ignored;
        }
        let rules = &scene.rules;
        rules.permission(travel.number, number, stroke.actuator)
    };
    let occupants = space.occupants();
    occupants
        .map(|(number, key)| (key, permission(number)))
        .collect()
}

impl<'a> Travel<'a> {
    /// Returns the sweep of the body's room, with the shape shrunk by `depth_mm`, from the start to the end of its way.
    fn passing(&self, depth_mm: f64) -> Result<Passing<'a>, Flaw> {
        let (mover, pose) = match self.ready {
            Some(ready) if depth_mm == 0.0 => {
                let position = sum(self.pose.position, self.unsure.low);
                (Cow::Borrowed(ready), self.pose.moved_to(position))
            }
            Some(_) | None => {
                let shape = self.shape.less(depth_mm);
                let (room, pose) = room(&shape, &self.pose, &self.unsure);
                (Cow::Owned(Mover::new(&room)?), pose)
            }
        };
        Ok(Passing {
            mover,
            from: pose.moved_to(sum(pose.position, self.from)),
            to: pose.moved_to(sum(pose.position, self.to)),
        })
    }
}

fn finding(
    space: &Space,
    stroke: &Stroke,
    start_known: bool,
    way: (f64, f64),
    (mover, found): (usize, Forbidden),
) -> FirstContact {
    let at_fraction = if start_known {
        found.contact.t_stop
    } else {
        0.0
    };
    let reached = way.0 + at_fraction * (way.1 - way.0);
    FirstContact {
        stroke: *stroke,
        mover,
        blocker: space.number_of(found.contact.blocker),
        distance_mm: found.distance_mm,
        margin_mm: found.margin_mm,
        at_fraction,
        at: found.contact.at,
        clear_way_mm: (at_fraction > 0.0).then_some((way.0, reached)),
    }
}
