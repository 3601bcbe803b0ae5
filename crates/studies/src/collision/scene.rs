//! The bodies of the study: scene and mover.
//!
//! The scene is a plate with stacks of one to five bodies at a pitch of 60 mm, heights in steps of 5 mm. Of twenty
//! bodies eight are cylinders, one is a rotated block, two are sheets of 0.1 to 0.5 mm, one is a wire of 0.5 to 2 mm,
//! the others are upright blocks. The mover is a gripper: two fingers, a palm, a round spindle, and a probe needle of
//! half a millimetre that reaches beyond the fingers.

use super::world::{MM, UNIT_MM};
use crate::dice::Dice;
use lpm::Shape;
use lpm::exact::{Body, Form, UPRIGHT};

/// Number of bodies of the scene.
const ELEMENTS: usize = 1_000;
/// Distance between neighbouring stacks, units.
const PITCH: i64 = 60 * MM;
/// Quaternions of the rotated blocks: about 37, 53, 67 and 77 degrees; sine and cosine of each angle are exact
/// fractions.
const TURNS: [[i64; 4]; 4] = [[3, 0, 0, 1], [2, 0, 0, 1], [3, 0, 0, 2], [5, 0, 0, 4]];

/// Draws the elements; returns them with the edge length of the plate and the height of the highest stack, both in
/// units.
pub fn stacks(dice: &mut Dice) -> (Vec<Body>, i64, i64) {
    let side = ((ELEMENTS as f64 / 3.0).sqrt().ceil()) as i64;
    let mut elements = vec![Body::block(
        [side * PITCH / 2, side * PITCH / 2, -5 * MM],
        [side * PITCH / 2, side * PITCH / 2, 5 * MM],
    )];
    let mut top = 0;
    for stack in 0.. {
        let (x, y) = (stack % side, stack / side);
        let mut bottom = 0;
        for _ in 0..dice.within(1, 5) {
            if elements.len() == ELEMENTS {
                return (elements, side * PITCH, top);
            }
            let height = 5 * MM * dice.within(4, 12);
            let jitter = |dice: &mut Dice| dice.within(-4 * MM, 4 * MM);
            let centre = [
                x * PITCH + PITCH / 2 + jitter(dice),
                y * PITCH + PITCH / 2 + jitter(dice),
                bottom + height / 2,
            ];
            elements.push(standing(dice, centre, height / 2));
            bottom += height;
            top = top.max(bottom);
        }
    }
    (elements, side * PITCH, top)
}

fn standing(dice: &mut Dice, centre: [i64; 3], half_height: i64) -> Body {
    let mut width = || dice.within(6 * MM, 20 * MM);
    let (x, y) = (width(), width());
    match dice.within(0, 19) {
        0..8 => Body::cylinder(centre, x, half_height),
        8 => Body {
            centre,
            form: Form::Block {
                half: [x, y, half_height],
                rotation: *dice.one(&TURNS),
            },
        },
        9 => Body::block(centre, [dice.within(MM / 20, MM / 4), y, half_height]),
        10 => Body::block(centre, [x, dice.within(MM / 20, MM / 4), half_height]),
        11 => Body::cylinder(centre, dice.within(MM / 4, MM), half_height),
        _ => Body::block(centre, [x, y, half_height]),
    }
}

/// Returns the parts of the mover: fingers, palm, spindle, needle.
pub fn gripper() -> Vec<Body> {
    vec![
        Body::block([-14 * MM, 0, 15 * MM], [3 * MM, 6 * MM, 15 * MM]),
        Body::block([14 * MM, 0, 15 * MM], [3 * MM, 6 * MM, 15 * MM]),
        Body::block([0, 0, 36 * MM], [20 * MM, 10 * MM, 6 * MM]),
        Body::cylinder([0, 0, 82 * MM], 9 * MM, 40 * MM),
        Body::cylinder([0, 0, 10 * MM], MM / 4, 20 * MM),
    ]
}

/// Returns the body with its radius and half extents smaller by one unit.
pub fn thinned(body: &Body) -> Body {
    let form = match body.form {
        Form::Block { half, rotation } => Form::Block {
            half: half.map(|it| it - 1),
            rotation,
        },
        Form::Cylinder { radius, half } => Form::Cylinder {
            radius: radius - 1,
            half: half - 1,
        },
        Form::Triangle(_) => body.form,
    };
    Body { form, ..*body }
}

/// Returns the body with a bounding box in place of a cylinder.
pub fn boxed(body: &Body) -> Body {
    let form = match body.form {
        Form::Cylinder { radius, half } => Form::Block {
            half: [radius, radius, half],
            rotation: UPRIGHT,
        },
        Form::Block { .. } | Form::Triangle(_) => body.form,
    };
    Body { form, ..*body }
}

/// Returns the parts as one compound shape of the collision core.
pub fn compound(parts: &[Body]) -> Shape {
    let placed = |part: &Body| (part.pose(UNIT_MM), part.shape(UNIT_MM));
    Shape::Compound(parts.iter().map(placed).collect())
}

/// Returns the half extents of an upright box around the body, units, rounded outward.
pub fn reach(body: &Body) -> [i64; 3] {
    match body.form {
        Form::Block { half, rotation } if rotation == UPRIGHT => half,
        Form::Block {
            half: [x, y, z], ..
        } => [x + y, x + y, z],
        Form::Cylinder { radius, half } => [radius, radius, half],
        Form::Triangle(corners) => {
            [0, 1, 2].map(|axis| corners.iter().map(|it| it[axis].abs()).max().unwrap_or(0))
        }
    }
}
