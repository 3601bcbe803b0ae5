//! Rows of the answers to planning questions, for JSON and for text.

use history::tooling::{PlanAction, PlanLeg, PlanStep};
use plan::{Assembly, Direction, Interference, LockedElements, Step, Verified};
use serde::Serialize;
use std::collections::BTreeMap;
use texts::{Lang, Message};

/// A cell of the interference table.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct BlockersRow {
    /// Id of the element that leaves.
    pub element: String,
    /// Direction in which `element` leaves: one of `+x`, `-x`, `+y`, `-y`, `+z`, `-z`.
    pub direction: &'static str,
    /// Elements that `element` meets on its way out.
    pub blockers: Vec<String>,
    /// Those of `blockers` that touch `element` and hold it in place.
    pub local: Vec<String>,
    /// Elements that the bounding box of `element`, extruded in this direction, meets.
    pub boxes: Vec<String>,
}

/// A set of elements that lock each other.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LockedRow {
    /// Ids of the elements that lock each other.
    pub locked: Vec<String>,
    /// For the id of each locked element, the elements that block its ways.
    pub by: BTreeMap<String, Vec<String>>,
}

fn ids<'a>(assembly: &Assembly, numbers: impl Iterator<Item = &'a usize>) -> Vec<String> {
    numbers.map(|it| assembly.id(*it).to_owned()).collect()
}

/// Rounds to a millionth of a millimetre.
fn rounded(mm: f64) -> f64 {
    (mm * 1e6).round() / 1e6
}

/// Returns a row per element and direction.
pub(super) fn blockers(
    assembly: &Assembly,
    [global, local, boxes]: [&Interference; 3],
) -> Vec<BlockersRow> {
    let named = |table: &Interference, number, direction| {
        let row = table.blockers(number, direction).iter();
        row.map(|it| assembly.id(*it as usize).to_owned()).collect()
    };
    let row = |number: usize, direction: Direction| BlockersRow {
        element: assembly.id(number).to_owned(),
        direction: direction.name(),
        blockers: named(global, number, direction),
        local: named(local, number, direction),
        boxes: named(boxes, number, direction),
    };
    (0..assembly.len())
        .flat_map(|number| Direction::ALL.map(|direction| row(number, direction)))
        .collect()
}

/// Returns the row of a step, whose legs already lead in the direction of `action`: off the scene or onto it. `held_by`
/// lists the elements in place that hold the moving ones.
pub(super) fn step(
    assembly: &Assembly,
    number: usize,
    action: PlanAction,
    step: &Step,
    (measured, held_by): (&Verified, &[usize]),
) -> Option<PlanStep> {
    let leg = |leg: &plan::Leg| PlanLeg {
        direction: leg.direction.name().to_owned(),
        distance_mm: rounded(leg.distance_mm),
    };
    let (first, then) = step.legs.split_first()?;
    let side = match action {
        PlanAction::Remove => step.side(),
        PlanAction::Add => step.legs.first().map(|leg| leg.direction.opposite()),
    };
    Some(PlanStep {
        step: number,
        action,
        elements: ids(assembly, step.elements.iter()),
        direction: first.direction.name().to_owned(),
        distance_mm: rounded(first.distance_mm),
        then: then.iter().map(leg).collect(),
        clearance_mm: measured.clearance_mm.map(rounded),
        slides_on: ids(assembly, measured.slides_on.iter()),
        clearance_to_others_mm: measured.clearance_to_others_mm.map(rounded),
        held_by: ids(assembly, held_by.iter()),
        tool_side: side?.name().to_owned(),
        on_bench: step.bench.is_some(),
    })
}

pub(super) fn locked(assembly: &Assembly, found: &LockedElements) -> LockedRow {
    let by = found.elements.iter().zip(&found.by);
    LockedRow {
        locked: ids(assembly, found.elements.iter()),
        by: by
            .map(|(element, by)| (assembly.id(*element).to_owned(), ids(assembly, by.iter())))
            .collect(),
    }
}

impl BlockersRow {
    /// Returns the row as text; `None` when nothing blocks.
    pub fn say(&self, lang: Lang) -> Option<String> {
        if self.blockers.is_empty() {
            return None;
        }
        let message = Message::new("plan", "blocked")
            .with("element", &self.element)
            .with("way", self.direction)
            .with("others", self.blockers.join(lang.comma()));
        Some(message.say(lang))
    }
}

impl LockedRow {
    /// Returns lines of text: the set, then for each of its elements what holds the element.
    pub fn say(&self, lang: Lang) -> Vec<String> {
        let set = Message::new("plan", "locked")
            .with("elements", self.locked.join(lang.comma()))
            .say(lang);
        let held = self.by.iter().map(|(element, by)| {
            Message::new("plan", "held")
                .with("element", element)
                .with("others", by.join(lang.comma()))
                .say(lang)
        });
        std::iter::once(set).chain(held).collect()
    }
}
