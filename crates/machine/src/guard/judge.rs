//! Judges a whole motion: checks the numbers, then sweeps stroke by stroke.
//!
//! The strokes of a group run in unknown order, so during the sweep of one every other member occupies its whole way.

use super::actuator::{Actuator, Position};
use super::motion::Motion;
use super::refusal::Refusal;
use super::scene::Scene;
use super::situation::Situation;
use super::space::Space;
use super::sweep::{FirstContact, sweep};

/// Returns the first contact of `motion`, if there is one.
///
/// # Errors
/// Fails for a position off its stroke, NaN included, and for an invalid part size.
pub(super) fn judge(
    scene: &Scene,
    space: &mut Space,
    motion: &Motion,
    situation: &Situation,
) -> Result<Option<FirstContact>, Refusal> {
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

/// Returns both ends as given; NaN stays NaN and lies on no stroke.
fn ends(position: Position) -> [f64; 2] {
    match position {
        Position::At(mm) => [mm, mm],
        Position::Between { from_mm, to_mm } => [from_mm, to_mm],
    }
}

/// Returns the situation of one stroke of a group, with every other member on its whole way.
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
