//! A whole motion judged: the numbers first, then stroke by stroke.
//!
//! The strokes of a group run in no known order, so while one is swept every other member of the
//! group occupies its whole way.

use super::actuator::{Actuator, Position};
use super::motion::Motion;
use super::refusal::Refusal;
use super::scene::Scene;
use super::situation::Situation;
use super::space::Space;
use super::sweep::{Finding, sweep};

/// The first contact of `motion`, if there is one.
///
/// # Errors
/// A position off its stroke, NaN included, or a part size that is none.
pub(super) fn judge(
    scene: &Scene,
    space: &mut Space,
    motion: &Motion,
    situation: &Situation,
) -> Result<Option<Finding>, Refusal> {
    check_numbers(scene, motion, situation)?;
    for stroke in motion.strokes() {
        let meanwhile = with_others_under_way(scene, motion, situation, stroke.actuator);
        let found = sweep(scene, space, &meanwhile, &stroke).map_err(|_| part_size(situation))?;
        if found.is_some() {
            return Ok(found);
        }
    }
    Ok(None)
}

fn check_numbers(scene: &Scene, motion: &Motion, situation: &Situation) -> Result<(), Refusal> {
    if !situation.part_size.is_sane() {
        return Err(part_size(situation));
    }
    for actuator in Actuator::ALL {
        let (low, high) = scene.axis(actuator).stroke_mm;
        let on_stroke = |mm: f64| {
            if (low..=high).contains(&mm) {
                Ok(())
            } else {
                Err(mm)
            }
        };
        let ends = situation.position(actuator).map_or([low, high], ends);
        let wanted = motion.target_mm(actuator).unwrap_or(low);
        for mm in [ends[0], ends[1], wanted] {
            on_stroke(mm).map_err(|found_mm| Refusal::OutOfStroke {
                actuator,
                found_mm,
                stroke_mm: (low, high),
            })?;
        }
    }
    Ok(())
}

/// Both ends as they were given; NaN stays NaN, which lies on no stroke.
fn ends(position: Position) -> [f64; 2] {
    match position {
        Position::At(mm) => [mm, mm],
        Position::Between { from_mm, to_mm } => [from_mm, to_mm],
    }
}

/// The situation of one stroke of a group: every other member occupies its whole way.
pub(super) fn with_others_under_way(
    scene: &Scene,
    motion: &Motion,
    situation: &Situation,
    moving: Actuator,
) -> Situation {
    let mut meanwhile = *situation;
    for other in motion.strokes().filter(|other| other.actuator != moving) {
        let (from_mm, to_mm) = scene.span_mm(other.actuator, situation);
        meanwhile.set(
            other.actuator,
            Position::Between { from_mm, to_mm }.reaching(other.to_mm),
        );
    }
    meanwhile
}

fn part_size(situation: &Situation) -> Refusal {
    let [x, y, z] = situation.part_size.body_mm;
    Refusal::PartSize {
        found_mm: [x, y, z, situation.part_size.pin_length_mm],
    }
}
