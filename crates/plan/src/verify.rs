//! Verification of a sequence: each step moves through the collision core with everything else in place.
//!
//! The verification uses no table. For each step the model holds exactly the elements that are still on the rig, or on
//! the bench beside the elements of the step. Clearances are those of the true bodies, without any depth taken off.

use crate::assembly::{Assembly, modelled};
use crate::error::PlanError;
use crate::sequence::Step;
use lpm::{ElementKey, Model, Move, Mover, Pose};

/// Greatest distance that a clearance reports, mm.
pub const RANGE_MM: f64 = 25.0;

/// Distances of a step that the collision core has found clear.
#[derive(Debug, Clone, PartialEq)]
pub struct Verified {
    /// Least distance to any element that stays during the step, mm: 0 when the step slides along an element; `None`
    /// beyond [`RANGE_MM`].
    pub clearance_mm: Option<f64>,
    /// Elements along which the step slides, in ascending order.
    pub slides_on: Vec<usize>,
    /// Least distance to the elements not in `slides_on`, mm; `None` beyond [`RANGE_MM`].
    pub clearance_to_others_mm: Option<f64>,
}

/// A step that the collision core refuses.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Refused {
    /// Place of the step in the sequence.
    pub step: usize,
    /// Number of the element that moves.
    pub mover: usize,
    /// Number of the element in the way; `None` when the collision core cannot decide.
    pub blocker: Option<usize>,
}

/// Place of an element during a sequence.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    Rig,
    /// On the bench, as part of the subassembly that left in this step.
    Bench(usize),
    Out,
}

/// Moves every step of a disassembly through the collision core and measures it.
///
/// # Errors
/// Fails on a flawed body. The inner result fails with the first step that the collision core refuses.
pub fn verified(
    assembly: &Assembly,
    steps: &[Step],
) -> Result<Result<Vec<Verified>, Refused>, PlanError> {
    let (movers, model) = modelled(assembly.elements(), 0.0, assembly.origin())?;
    let whole = Whole {
        assembly,
        keys: model.keys().collect(),
        model,
        movers,
    };
    let mut places = vec![Place::Rig; assembly.len()];
    let mut found = Vec::new();
    for (number, step) in steps.iter().enumerate() {
        let here = step.bench.map_or(Place::Rig, Place::Bench);
        let is_subassembly = steps.iter().any(|it| it.bench == Some(number));
        match whole.measured(step, &places, here) {
            Ok(measured) => found.push(measured),
            Err((mover, blocker)) => {
                return Ok(Err(Refused {
                    step: number,
                    mover,
                    blocker,
                }));
            }
        }
        for element in &step.elements {
            places[*element] = if is_subassembly {
                Place::Bench(number)
            } else {
                Place::Out
            };
        }
    }
    Ok(Ok(found))
}

/// The elements with their true bodies, for a check of each step.
struct Whole<'a> {
    assembly: &'a Assembly,
    model: Model,
    keys: Vec<ElementKey>,
    movers: Vec<Mover>,
}

impl Whole<'_> {
    /// Measures a step; fails with the mover and its blocker when the step is refused.
    fn measured(
        &self,
        step: &Step,
        places: &[Place],
        here: Place,
    ) -> Result<Verified, (usize, Option<usize>)> {
        let stands = |element: usize| places[element] == here && !step.elements.contains(&element);
        if let Some(moved) = step.elements.iter().find(|it| places[**it] != here) {
            return Err((*moved, None));
        }
        let mut slides_on: Vec<usize> = Vec::new();
        let (mut least, mut of_others): (Option<f64>, Option<f64>) = (None, None);
        for mover in &step.elements {
            let mut from = [0.0; 3];
            for leg in &step.legs {
                let by = leg.direction.displacement(leg.distance_mm);
                let to = [0, 1, 2].map(|axis| from[axis] + by[axis]);
                let guides = self.assembly.guiding(*mover, leg.direction);
                if let Some(guide) = guides.into_iter().find(|it| stands(*it as usize)) {
                    return Err((*mover, Some(guide as usize)));
                }
                let absent = |element: &usize| {
                    !stands(*element) || self.assembly.is_guided(*mover, *element)
                };
                let ignored = |keys: &dyn Fn(usize) -> ElementKey| -> Vec<ElementKey> {
                    (0..places.len()).filter(absent).map(keys).collect()
                };
                let ends = [from, to].map(|by| self.assembly.pose(*mover, by));
                let thin = ignored(&|element| self.assembly.key(element));
                let hit = self
                    .assembly
                    .model()
                    .any_hit(self.assembly.mover(*mover), &between(ends, &thin, 0.0));
                if let Some(hit) = hit {
                    let blocker = (0..places.len()).find(|it| self.assembly.key(*it) == hit);
                    return Err((*mover, blocker));
                }
                let mut ignore = ignored(&|element| self.keys[element]);
                let body = &self.movers[*mover];
                let all = self
                    .model
                    .clearance(body, &between(ends, &ignore, 0.0), RANGE_MM);
                least = nearer(least, all.map(|it| it.distance_mm));
                let contact_mm = self.assembly.tolerance().contact_mm;
                let touched = self
                    .model
                    .every_hit(body, &between(ends, &ignore, contact_mm));
                let numbers = (0..places.len()).filter(|it| touched.contains(&self.keys[*it]));
                slides_on.extend(numbers);
                ignore.extend(touched);
                let others = self
                    .model
                    .clearance(body, &between(ends, &ignore, 0.0), RANGE_MM);
                of_others = nearer(of_others, others.map(|it| it.distance_mm));
                from = to;
            }
        }
        slides_on.sort_unstable();
        slides_on.dedup();
        Ok(Verified {
            clearance_mm: least,
            slides_on,
            clearance_to_others_mm: of_others,
        })
    }
}

fn between([from, to]: [Pose; 2], ignore: &[ElementKey], margin_mm: f64) -> Move<'_> {
    Move {
        from,
        to,
        margin_mm,
        ignore,
    }
}

fn nearer(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (known, None) | (None, known) => known,
    }
}
