//! A step of a plan: which elements move, where to, and how near they come to everything else.

use serde::{Deserialize, Serialize};
use texts::{Lang, Message};
use utoipa::ToSchema;

/// A straight part of a path.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct PlanLeg {
    /// Direction of the move, `+x` to `-z`.
    #[schema(example = "+z")]
    pub direction: String,
    /// Length of the move, mm.
    pub distance_mm: f64,
}

/// What a step does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum PlanAction {
    /// Takes elements off.
    Remove,
    /// Puts elements on.
    Add,
}

/// A step of a plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct PlanStep {
    /// Number of the step, from 1.
    pub step: usize,
    /// Whether the step takes elements off or puts them on.
    pub action: PlanAction,
    /// Ids of the elements that move together.
    pub elements: Vec<String>,
    /// Direction of the first leg, `+x` to `-z`.
    #[schema(example = "+z")]
    pub direction: String,
    /// Length of the first leg, mm.
    pub distance_mm: f64,
    /// Further legs; empty for a straight path.
    pub then: Vec<PlanLeg>,
    /// Least distance to anything that stays in place, mm: 0 when the step slides; null beyond 25 mm.
    pub clearance_mm: Option<f64>,
    /// Elements along which the step slides.
    pub slides_on: Vec<String>,
    /// Least distance to anything but the elements of `slides_on`, mm; null beyond 25 mm.
    pub clearance_to_others_mm: Option<f64>,
    /// Elements in place that block another direction of the moving ones.
    pub held_by: Vec<String>,
    /// Side from which a tool or a hand reaches the elements, `+x` to `-z`.
    #[schema(example = "+z")]
    pub tool_side: String,
    /// True for a step on the bench: the elements are part of a subassembly that moves as a whole.
    pub on_bench: bool,
}

impl PlanStep {
    /// Yields all legs in the order of the move.
    pub fn legs(&self) -> impl Iterator<Item = (&str, f64)> {
        let first = std::iter::once((self.direction.as_str(), self.distance_mm));
        let then = self.then.iter();
        first.chain(then.map(|it| (it.direction.as_str(), it.distance_mm)))
    }

    /// Returns the text for the least distance: a length, rounded down to 0.001 mm, or a remark that the distance is
    /// beyond the range of the search.
    pub fn clearance(&self, lang: Lang) -> String {
        match self.clearance_mm {
            Some(mm) => format!("{} mm", (mm * 1e3).floor() / 1e3),
            None => Message::new("plan", "beyond").say(lang),
        }
    }

    /// Returns the step as a sentence for a mechanic.
    pub fn say(&self, lang: Lang) -> String {
        let legs = self.legs();
        let way: Vec<String> = legs.map(|(way, mm)| format!("{way} {mm} mm")).collect();
        let code = match (self.action, self.on_bench) {
            (PlanAction::Remove, false) => "remove",
            (PlanAction::Add, false) => "add",
            (PlanAction::Remove, true) => "remove_on_bench",
            (PlanAction::Add, true) => "add_on_bench",
        };
        Message::new("plan", code)
            .with("number", self.step)
            .with("elements", self.elements.join(lang.comma()))
            .with("way", way.join(lang.comma()))
            .with("distance", self.clearance(lang))
            .with("from", &self.tool_side)
            .say(lang)
    }
}

/// Returns the name of a side, with its direction: `right (+x)`.
pub fn side_name(lang: Lang, direction: &str) -> String {
    let code = match direction {
        "+x" => "right",
        "-x" => "left",
        "+y" => "rear",
        "-y" => "front",
        "+z" => "top",
        "-z" => "bottom",
        other => return other.to_owned(),
    };
    let name = lang.text(&format!("tooling_side-{code}"));
    match lang {
        Lang::En => format!("{name} ({direction})"),
        Lang::Zh => format!("{name}\u{ff08}{direction}\u{ff09}"),
    }
}
