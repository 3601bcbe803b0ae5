//! One stroke swept through the space.
//!
//! Every body that moves with the stroke is swept, in its true shape, along the whole way and
//! asked of the collision core against the room that every other body may take. A mover that also
//! rides on an actuator of unknown position is swept as the cover of its own room. So, for every
//! real combination of positions that the situation allows, the real bodies lie inside what was
//! tested: a cleared stroke is clear for all of them.
//!
//! The core answers one margin at a time: the other bodies are grouped by what the mover must keep
//! from them. Where two may touch, the mover is tested with the depth taken off its faces.

use super::carried::{Company, company};
use super::motion::Stroke;
use super::occupancy::{Offsets, room, scaled, shrunk, sum};
use super::part::{Role, shape_of};
use super::rules::Keep;
use super::scene::Scene;
use super::situation::Situation;
use super::space::Space;
use crate::lpm::{Answer, Contact, ElementKey, Flaw, Move, Mover, Moving, Pose, Shape};
use std::borrow::Cow;

/// How far beyond the margin a refusal still measures the least distance, mm.
const MEASURED_BEYOND_MM: f64 = 1.0;

/// The first contact of a stroke.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Finding {
    pub stroke: Stroke,
    /// Body numbers; `None` when the core could not decide.
    pub mover: usize,
    pub blocker: Option<usize>,
    pub distance_mm: f64,
    pub margin_mm: f64,
    pub at_fraction: f64,
    pub at: [f64; 3],
    /// Where the stroke was swept from and where the margin is reached, mm; `None` when the start is
    /// unknown or within the margin.
    pub clear_way_mm: Option<(f64, f64)>,
}

/// A body on its way.
struct Travel<'a> {
    number: usize,
    shape: Cow<'a, Shape>,
    /// The same taken apart beforehand, where its place beside the stroke is known.
    ready: Option<&'a Mover>,
    pose: Pose,
    /// Where it may be on the actuators that do not move.
    unsure: Offsets,
    from: [f64; 3],
    to: [f64; 3],
}

/// A contact of one mover.
struct Hit {
    mover: usize,
    contact: Contact,
    distance_mm: f64,
    margin_mm: f64,
}

/// Sweeps `stroke` from where `situation` has its actuator; `Ok(None)` is proof that it is clear.
pub(super) fn sweep(
    scene: &Scene,
    space: &mut Space,
    situation: &Situation,
    stroke: &Stroke,
) -> Result<Option<Finding>, Flaw> {
    let company = company(scene, situation, stroke);
    space.follow(scene, situation, &company.cast)?;
    let span = scene.span_mm(stroke.actuator, situation);
    let way = way(span, stroke.to_mm);
    let travels = travels(scene, situation, stroke, &company, way);
    let moving: Vec<usize> = travels.iter().map(|travel| travel.number).collect();
    let mut first: Option<Hit> = None;
    for travel in &travels {
        let hit = first_hit(scene, space, stroke, travel, &moving, &company);
        if let Some(hit) = hit
            && first
                .as_ref()
                .is_none_or(|known| hit.contact.t_stop < known.contact.t_stop)
        {
            first = Some(hit);
        }
    }
    Ok(first.map(|hit| finding(space, stroke, span.0 == span.1, way, &hit)))
}

/// Least distance of `stroke` to the bodies that it must keep apart from, mm; nothing beyond `range_mm`. Those that may
/// touch do not count.
pub(super) fn least_mm(
    scene: &Scene,
    space: &mut Space,
    situation: &Situation,
    stroke: &Stroke,
    range_mm: f64,
) -> Result<Option<f64>, Flaw> {
    let company = company(scene, situation, stroke);
    space.follow(scene, situation, &company.cast)?;
    let way = way(scene.span_mm(stroke.actuator, situation), stroke.to_mm);
    let travels = travels(scene, situation, stroke, &company, way);
    let moving: Vec<usize> = travels.iter().map(|travel| travel.number).collect();
    let all = travels.iter().filter_map(|travel| {
        let kept = kept(scene, space, stroke, travel, &moving, &company);
        let apart = |keep: &Keep| matches!(keep, Keep::Apart(_));
        let ignore: Vec<ElementKey> = kept
            .iter()
            .filter(|(_, keep)| !apart(keep))
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

/// From the far end of what is known to the target; both ends of the span when the target lies in it.
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
    company: &Company,
    way: (f64, f64),
) -> Vec<Travel<'a>> {
    let tooling = scene.bodies.iter().enumerate();
    let tooling = tooling.map(|(number, body)| (number, Cow::Borrowed(&body.shape), body.pose));
    let part = company.taken.map(|role| {
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

fn first_hit(
    scene: &Scene,
    space: &Space,
    stroke: &Stroke,
    travel: &Travel<'_>,
    moving: &[usize],
    company: &Company,
) -> Option<Hit> {
    let kept = kept(scene, space, stroke, travel, moving, company);
    let mut groups: Vec<Keep> = Vec::new();
    for (_, keep) in &kept {
        if *keep != Keep::Nothing && !groups.contains(keep) {
            groups.push(*keep);
        }
    }
    let hits = groups
        .iter()
        .filter_map(|keep| hit_in_group(space, travel, *keep, &kept));
    hits.min_by(|a, b| a.contact.t_stop.total_cmp(&b.contact.t_stop))
}

/// What `travel` must keep from every body in the space; nothing from those that move with it.
fn kept(
    scene: &Scene,
    space: &Space,
    stroke: &Stroke,
    travel: &Travel<'_>,
    moving: &[usize],
    company: &Company,
) -> Vec<(ElementKey, Keep)> {
    let left = company.left.map(|role| scene.number_of(role));
    let keep = |number: usize| {
        if moving.contains(&number) || left == Some(number) {
            return Keep::Nothing;
        }
        scene.rules.keep(travel.number, number, stroke.actuator)
    };
    let occupants = space.occupants();
    occupants.map(|(number, key)| (key, keep(number))).collect()
}

fn hit_in_group(
    space: &Space,
    travel: &Travel<'_>,
    keep: Keep,
    kept: &[(ElementKey, Keep)],
) -> Option<Hit> {
    let (shape, margin_mm) = match keep {
        Keep::Apart(margin_mm) => {
            if let Some(mover) = travel.ready {
                let pose = travel
                    .pose
                    .moved_to(sum(travel.pose.position, travel.unsure.low));
                return ask(space, travel, mover, pose, keep, margin_mm, kept);
            }
            (Cow::Borrowed(&*travel.shape), margin_mm)
        }
        Keep::Depth(depth_mm) => (Cow::Owned(shrunk(&travel.shape, depth_mm)), 0.0),
        Keep::Nothing => return None,
    };
    let (shape, pose) = room(&shape, &travel.pose, &travel.unsure);
    ask(space, travel, &*shape, pose, keep, margin_mm, kept)
}

/// First contact of `body`, standing at `pose` before the stroke, with those to which `keep` applies.
fn ask(
    space: &Space,
    travel: &Travel<'_>,
    body: &impl Moving,
    pose: Pose,
    keep: Keep,
    margin_mm: f64,
    kept: &[(ElementKey, Keep)],
) -> Option<Hit> {
    let ignore: Vec<ElementKey> = kept
        .iter()
        .filter(|(_, other)| *other != keep)
        .map(|(key, _)| *key)
        .collect();
    let from = pose.moved_to(sum(pose.position, travel.from));
    let to = pose.moved_to(sum(pose.position, travel.to));
    let contact = match space.model().first_contact(
        body,
        &Move {
            from,
            to,
            margin_mm,
            ignore: &ignore,
        },
    ) {
        Answer::Clear => return None,
        Answer::Blocked(contact) => contact,
    };
    let ignore: Vec<ElementKey> = kept
        .iter()
        .map(|(key, _)| *key)
        .filter(|key| *key != contact.blocker)
        .collect();
    let alone = Move {
        from,
        to,
        margin_mm,
        ignore: &ignore,
    };
    let least = space
        .model()
        .clearance(body, &alone, margin_mm + MEASURED_BEYOND_MM);
    let distance_mm = least.map_or(contact.distance_mm, |least| least.distance_mm);
    Some(Hit {
        mover: travel.number,
        contact,
        distance_mm,
        margin_mm,
    })
}

fn finding(
    space: &Space,
    stroke: &Stroke,
    start_known: bool,
    way: (f64, f64),
    hit: &Hit,
) -> Finding {
    let at_fraction = if start_known { hit.contact.t_stop } else { 0.0 };
    let reached = way.0 + at_fraction * (way.1 - way.0);
    Finding {
        stroke: *stroke,
        mover: hit.mover,
        blocker: space.number_of(hit.contact.blocker),
        distance_mm: hit.distance_mm,
        margin_mm: hit.margin_mm,
        at_fraction,
        at: hit.contact.at,
        clear_way_mm: (at_fraction > 0.0).then_some((way.0, reached)),
    }
}
