//! Reads the scene a second time, as plain boxes, to check the motions that the guard clears.
//!
//! This reading replaces a cylinder by the box inside it, so that no clear pose counts as a collision.

#![allow(clippy::unwrap_used)]

use super::*;

/// A body as boxes (centre, half extents).
pub(super) struct Boxed {
    pub id: String,
    pub rides: Option<Actuator>,
    opposed: bool,
    pub boxes: Vec<([f64; 3], [f64; 3])>,
}

pub(super) fn boxed(settings: &GuardSettings) -> Vec<Boxed> {
    let opposed = |id: &str| {
        settings
            .actuator
            .iter()
            .any(|a| a.opposed.iter().any(|o| o == id))
    };
    let one = |e: &Element| {
        let mut boxes = Vec::new();
        let own = Piece {
            kind: e.kind,
            half: e.half,
            radius: e.radius,
            height: e.height,
            parts: e.parts.clone(),
            pose: PoseSettings::default(),
        };
        inner_boxes(&own, e.pose.position, e.pose.rotation[0] < 1.0, &mut boxes);
        Boxed {
            id: e.id.clone(),
            rides: e.rides,
            opposed: opposed(&e.id),
            boxes,
        }
    };
    settings.elements.iter().map(one).collect()
}

/// Appends the boxes of a piece; `lying`: rotated from z onto x, the only rotation in the scene.
fn inner_boxes(piece: &Piece, at: [f64; 3], lying: bool, out: &mut Vec<([f64; 3], [f64; 3])>) {
    match piece.kind {
        ShapeKind::Block => out.push((at, piece.half.unwrap())),
        ShapeKind::Cylinder => {
            let side = piece.radius.unwrap() / 2f64.sqrt();
            let half = piece.height.unwrap() / 2.0;
            out.push((
                at,
                if lying {
                    [half, side, side]
                } else {
                    [side, side, half]
                },
            ));
        }
        ShapeKind::Compound => {
            for part in piece.parts.as_ref().unwrap() {
                let shift = part.pose.position;
                inner_boxes(part, std::array::from_fn(|i| at[i] + shift[i]), lying, out);
            }
        }
    }
}

fn part_boxes(settings: &GuardSettings, rear: [f64; 3]) -> Vec<([f64; 3], [f64; 3])> {
    let PartSize {
        body_mm: [x, y, z],
        pin_length_mm: pins,
    } = jzc_22f();
    let inset = settings.guard.pin_inset_mm;
    let at = |dz: f64| [rear[0] + x / 2.0, rear[1], rear[2] + dz];
    vec![
        (at(z / 2.0), [x / 2.0, y / 2.0, z / 2.0]),
        (
            at(-pins / 2.0),
            [x / 2.0 - inset, y / 2.0 - inset, pins / 2.0],
        ),
    ]
}

type Strokes = [f64; 8];

fn offset(
    settings: &GuardSettings,
    actuator: Option<Actuator>,
    opposed: bool,
    mm: &Strokes,
) -> [f64; 3] {
    let Some(actuator) = actuator else {
        return [0.0; 3];
    };
    let axis = settings
        .actuator
        .iter()
        .find(|axis| axis.id == actuator)
        .unwrap();
    let carried = offset(settings, axis.rides, false, mm);
    let sign = if opposed { -1.0 } else { 1.0 };
    std::array::from_fn(|i| carried[i] + sign * axis.axis[i] * mm[actuator as usize])
}

/// Returns every body in the space at these strokes, by id.
pub(super) fn placed(
    settings: &GuardSettings,
    bodies: &[Boxed],
    parts: &PartPlaces,
    mm: &Strokes,
) -> Vec<Boxed> {
    let mut all = Vec::new();
    for body in bodies {
        let by = offset(settings, body.rides, body.opposed, mm);
        let boxes = body
            .boxes
            .iter()
            .map(|(c, h)| (std::array::from_fn(|i| c[i] + by[i]), *h))
            .collect();
        all.push(Boxed {
            id: body.id.clone(),
            boxes,
            ..*body
        });
    }
    let mut part = |id: &str, rear: [f64; 3], rides: Option<Actuator>| {
        all.push(Boxed {
            id: id.to_owned(),
            rides,
            opposed: false,
            boxes: part_boxes(settings, rear),
        });
    };
    let policy = &settings.guard;
    let plus = |a: [f64; 3], b: [f64; 3]| std::array::from_fn(|i| a[i] + b[i]);
    if parts.pocket {
        part("part_pocket", policy.pocket, None);
    }
    if parts.on_pusher {
        let by = offset(settings, Some(Actuator::Pusher), false, mm);
        part(
            "part_pusher",
            plus(policy.pocket, by),
            Some(Actuator::Pusher),
        );
    }
    if parts.nest {
        part("part_nest", policy.nest, None);
    }
    if parts.gripper {
        let by = plus(
            offset(settings, Some(Actuator::SortZ), false, mm),
            [0.0, 0.0, 40.0],
        );
        part("part_gripper", plus(policy.nest, by), Some(Actuator::SortZ));
    }
    all
}

/// Returns the distance of two boxes; negative for the depth of their overlap.
pub(super) fn gap(a: &([f64; 3], [f64; 3]), b: &([f64; 3], [f64; 3])) -> f64 {
    let gaps: [f64; 3] = std::array::from_fn(|i| (a.0[i] - b.0[i]).abs() - a.1[i] - b.1[i]);
    let apart: f64 = gaps.iter().map(|g| g.max(0.0).powi(2)).sum();
    if apart > 0.0 {
        apart.sqrt()
    } else {
        gaps.iter().copied().fold(f64::NEG_INFINITY, f64::max)
    }
}

/// Returns the least gap that the pair rules allow; `None` for an untested pair.
pub(super) fn least_gap(settings: &GuardSettings, a: &str, b: &str) -> Option<f64> {
    let fits = |pattern: &str, id: &str| match pattern.strip_suffix('*') {
        Some(stem) => id.starts_with(stem),
        None => pattern == id,
    };
    let named =
        |p: &&PairSettings| fits(&p.a, a) && fits(&p.b, b) || fits(&p.a, b) && fits(&p.b, a);
    match settings
        .pair
        .iter()
        .rfind(named)
        .map(|p| (p.rule, p.depth_mm))
    {
        Some((PairRule::Ignore, _)) => None,
        Some((PairRule::MayTouch, depth)) => Some(-depth.unwrap_or(settings.guard.touch_depth_mm)),
        Some((PairRule::Forbidden, _)) | None => Some(settings.guard.default_margin_mm),
    }
}

pub(super) fn moves_with(
    settings: &GuardSettings,
    rides: Option<Actuator>,
    actuator: Actuator,
) -> bool {
    rides.is_some_and(|carrier| {
        let next = settings
            .actuator
            .iter()
            .find(|axis| axis.id == carrier)
            .and_then(|axis| axis.rides);
        carrier == actuator || moves_with(settings, next, actuator)
    })
}
