//! Rows of answers, for JSON and for text.

use plan::{Assembly, Direction, Interference, LockedElements, Step, Verified};
use serde::Serialize;
use std::collections::BTreeMap;
use texts::{Lang, Message};

/// A cell of the interference table.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct BlockersRow {
    /// Id of the element that leaves.
    pub element: String,
    /// Direction in which it leaves: `+x` to `-z`.
    pub direction: &'static str,
    /// Elements that it meets on its way out.
    pub blockers: Vec<String>,
    /// Those of them that hold it where it is.
    pub local: Vec<String>,
    /// Elements that its extruded box meets.
    pub boxes: Vec<String>,
}

/// A straight part of a way.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LegRow {
    /// Direction of the move.
    pub direction: &'static str,
    /// Length of the move, mm.
    pub distance_mm: f64,
}

/// What a step does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Action {
    /// Takes elements off.
    Remove,
    /// Puts elements on.
    Add,
}

/// A step of a plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StepRow {
    /// Number of the step, from 1.
    pub step: usize,
    /// What it does.
    pub action: Action,
    /// Ids of the elements that move together.
    pub elements: Vec<String>,
    /// Direction of the first leg.
    pub direction: &'static str,
    /// Length of the first leg, mm.
    pub distance_mm: f64,
    /// Further legs; none for a straight way.
    pub then: Vec<LegRow>,
    /// Least distance to anything that stays in place, mm: 0 when the step slides; null beyond 25 mm.
    pub clearance_mm: Option<f64>,
    /// Elements along which the step slides.
    pub slides_on: Vec<String>,
    /// Least distance to everything else, mm; null beyond 25 mm.
    pub clearance_to_others_mm: Option<f64>,
    /// Side from which a tool or a hand reaches the elements.
    pub tool_side: &'static str,
    /// True for a step on the bench: the elements are part of a subassembly that moves as a whole.
    pub on_bench: bool,
}

/// A locked set.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LockedRow {
    /// Ids of the elements that lock each other.
    pub locked: Vec<String>,
    /// For each of them, what blocks its ways.
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

/// Returns the row of a step that takes elements off, or that puts them on when it is a step of the assembly.
pub(super) fn step(
    assembly: &Assembly,
    number: usize,
    action: Action,
    step: &Step,
    measured: &Verified,
) -> Option<StepRow> {
    let leg = |leg: &plan::Leg| LegRow {
        direction: leg.direction.name(),
        distance_mm: rounded(leg.distance_mm),
    };
    let (first, then) = step.legs.split_first()?;
    let side = match action {
        Action::Remove => step.side(),
        Action::Add => step.legs.first().map(|leg| leg.direction.opposite()),
    };
    Some(StepRow {
        step: number,
        action,
        elements: ids(assembly, step.elements.iter()),
        direction: first.direction.name(),
        distance_mm: rounded(first.distance_mm),
        then: then.iter().map(leg).collect(),
        clearance_mm: measured.clearance_mm.map(rounded),
        slides_on: ids(assembly, measured.slides_on.iter()),
        clearance_to_others_mm: measured.clearance_to_others_mm.map(rounded),
        tool_side: side.map_or("", Direction::name),
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

impl StepRow {
    /// Returns the step as a sentence for a mechanic.
    pub fn say(&self, lang: Lang) -> String {
        let first = format!("{} {} mm", self.direction, self.distance_mm);
        let legs = self.then.iter();
        let legs = legs.map(|leg| format!("{} {} mm", leg.direction, leg.distance_mm));
        let way: Vec<String> = std::iter::once(first).chain(legs).collect();
        let code = match (self.action, self.on_bench) {
            (Action::Remove, false) => "remove",
            (Action::Add, false) => "add",
            (Action::Remove, true) => "remove_on_bench",
            (Action::Add, true) => "add_on_bench",
        };
        let distance = match self.clearance_mm {
            Some(mm) => format!("{mm} mm"),
            None => Message::new("plan", "beyond").say(lang),
        };
        Message::new("plan", code)
            .with("number", self.step)
            .with("elements", self.elements.join(lang.comma()))
            .with("way", way.join(lang.comma()))
            .with("distance", distance)
            .with("from", self.tool_side)
            .say(lang)
    }
}

impl LockedRow {
    /// Returns the set as lines: the set, then what holds each of its elements.
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
