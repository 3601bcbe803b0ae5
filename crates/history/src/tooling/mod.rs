//! Plans by which people take tooling off a rig and put it on: steps with drawings, and which of them are done.
//!
//! The planner (crate `app`) makes a [`ToolingPlan`]; this module stores the plan when a person starts it, so a later
//! change of the configuration does not change a plan under way. At most one plan is under way. People tick off its
//! steps in order, each with person and time, until the last one is done or a person abandons the plan.

mod kept;
mod step;

pub use kept::{Actor, PlanEnd, PlanEntry, PlanRefusal, StartedPlan, StepDone};
pub use step::{PlanAction, PlanLeg, PlanStep, side_name};

use serde::{Deserialize, Serialize};
use std::collections::HashSet;
use texts::Lang;
use utoipa::ToSchema;

/// Purpose of a plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum PlanKind {
    /// From one scene to another.
    Changeover,
    /// Takes elements off.
    Disassembly,
    /// Puts elements on.
    Assembly,
}

impl PlanKind {
    /// Returns the word in files and over HTTP.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Changeover => "changeover",
            Self::Disassembly => "disassembly",
            Self::Assembly => "assembly",
        }
    }
}

/// What a changeover does with each element, by ids.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize, ToSchema)]
pub struct ChangeoverRow {
    /// Elements that stay in place.
    pub stays: Vec<String>,
    /// Elements that come off for good.
    pub goes: Vec<String>,
    /// Elements that are put on for the first time.
    pub comes: Vec<String>,
    /// Elements that come off and go back on.
    pub returns: Vec<String>,
}

/// A plan with everything that a page or a drawing shows of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ToolingPlan {
    /// Purpose of the plan.
    pub kind: PlanKind,
    /// Name of the scene that the plan begins with.
    pub scene: String,
    /// Name of the scene to which a changeover leads.
    pub to: Option<String>,
    /// Ids of the elements that a disassembly must take off; empty for all that do not stay.
    pub remove: Vec<String>,
    /// What a changeover does with each element.
    pub summary: Option<ChangeoverRow>,
    /// The steps in their order.
    pub steps: Vec<PlanStep>,
    /// Bodies of each scene, in the order in which `pictures` counts scenes.
    pub scenes: Vec<Vec<PlanBody>>,
    /// By step: the surroundings that its picture shows.
    pub pictures: Vec<PlanPicture>,
}

/// A body of a scene as drawings show it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlanBody {
    /// Id of the element.
    pub id: String,
    /// Convex polygons from above: x to the right, y up, mm.
    pub above: Vec<Vec<[f64; 2]>>,
    /// Convex polygons from the front: x to the right, z up, mm.
    pub front: Vec<Vec<[f64; 2]>>,
}

/// Surroundings of a step: a scene, or a subassembly on the bench.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PlanPicture {
    /// Index of the scene in `scenes`.
    pub scene: usize,
    /// For a step on the bench: the index of the step that moves the subassembly as a whole.
    pub subassembly: Option<usize>,
}

impl ToolingPlan {
    /// Returns the indexes of the bodies that stay in place while the step with index `place` moves its elements.
    pub fn standing(&self, place: usize) -> Vec<usize> {
        assert_eq!(
            self.pictures.len(),
            self.steps.len(),
            "a picture for each step"
        );
        let picture = &self.pictures[place];
        let step = &self.steps[place];
        // Elements that have left before, elements that come later, and the elements of the step itself are absent.
        let is_absent = |other: usize| match step.action {
            PlanAction::Remove => other <= place,
            PlanAction::Add => other >= place,
        };
        let counts = |other: &usize| {
            is_absent(*other)
                && self.steps[*other].action == step.action
                && (picture.subassembly.is_none()
                    || self.pictures[*other].subassembly == picture.subassembly)
        };
        let absent: HashSet<&String> = (0..self.steps.len())
            .filter(counts)
            .flat_map(|other| &self.steps[other].elements)
            .collect();
        let whole = picture.subassembly.map(|it| &self.steps[it].elements);
        let stands = |body: &PlanBody| {
            !absent.contains(&body.id) && whole.is_none_or(|it| it.contains(&body.id))
        };
        let bodies = self.scenes[picture.scene].iter().enumerate();
        bodies
            .filter(|(_, body)| stands(body))
            .map(|(number, _)| number)
            .collect()
    }
}

/// Returns the name of an element; a plant's own scene may have elements without a text, which are named by their ids.
pub fn element_name(lang: Lang, id: &str) -> String {
    let known = lang.name("body", id);
    if known == id {
        id.replace('_', " ")
    } else {
        known.to_owned()
    }
}
