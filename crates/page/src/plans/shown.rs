//! Plans as the page gets them: rows with their pictures, drawn by the server.

use history::report::plan_drawing::{PlanView, picture, shapes};
use history::tooling::{
    ChangeoverRow, PlanEntry, PlanKind, PlanStep, StartedPlan, StepDone, ToolingPlan,
};
use serde::{Deserialize, Serialize};
use std::fmt::Debug;
use utoipa::ToSchema;

/// Fault of a scene or a question as English text, with all its causes.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct PlanFault(pub String);

/// Makes plans; crate `app` implements it.
pub trait PlanMaker: Debug + Send + Sync {
    /// Returns the scenes of the configuration, the scene of the rig first.
    ///
    /// # Errors
    /// Fails on a faulty scene.
    fn scenes(&self) -> Result<Vec<ListedScene>, PlanFault>;

    /// Makes a plan.
    ///
    /// # Errors
    /// Fails on a faulty scene or contradicting demands.
    fn make(&self, question: &PlanQuestion) -> Result<PlanAnswer, PlanFault>;
}

/// A scene of the configuration.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct ListedScene {
    /// Name of the scene file, relative to the folder of the configuration.
    #[schema(example = "scene.toml")]
    pub name: String,
    /// Ids of the elements in the scene.
    pub elements: Vec<String>,
}

/// Question for a plan.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PlanQuestion {
    /// Kind of the plan.
    pub kind: PlanKind,
    /// Scene with which the plan begins.
    #[schema(example = "scene.toml")]
    pub scene: String,
    /// Scene to which a changeover leads.
    #[schema(example = "nests/body-18x12.toml")]
    pub to: Option<String>,
    /// Ids of the elements that a disassembly must take off; the plan also takes off whatever is in their way.
    #[serde(default)]
    pub remove: Vec<String>,
    /// Directions in which no element may leave: `+x`, `-x`, `+y`, `-y`, `+z`, `-z`.
    #[serde(default)]
    pub forbid: Vec<String>,
}

/// Answer of a [`PlanMaker`].
#[derive(Debug, Clone)]
pub enum PlanAnswer {
    /// A sequence of steps exists.
    Plan(Box<ToolingPlan>),
    /// No sequence exists; these elements lock each other.
    Locked(Vec<String>),
}

/// A plan with its pictures.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct ShownPlan {
    kind: PlanKind,
    /// Scene with which the plan begins.
    scene: String,
    /// Scene to which a changeover leads.
    to: Option<String>,
    /// Elements that a disassembly takes off.
    remove: Vec<String>,
    /// What a changeover does with each element.
    summary: Option<ChangeoverRow>,
    /// SVG with all bodies, to which the pictures refer; must be in the same document as the pictures.
    shapes: String,
    steps: Vec<ShownStep>,
}

/// A step with its pictures.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct ShownStep {
    #[serde(flatten)]
    step: PlanStep,
    /// SVG of the step from above.
    above: String,
    /// SVG of the step from the front.
    front: String,
    /// Who has done the step, and when; null while it is not done.
    done: Option<StepDone>,
}

/// A plan that was started.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct StartedView {
    #[serde(flatten)]
    entry: PlanEntry,
    /// The steps with their pictures.
    shown: ShownPlan,
}

impl ShownPlan {
    pub fn new(plan: &ToolingPlan, ticks: &[StepDone]) -> Self {
        let drawn = |place: usize, view| picture(plan, place, view, "");
        let steps = plan
            .steps
            .iter()
            .enumerate()
            .map(|(place, step)| ShownStep {
                step: step.clone(),
                above: drawn(place, PlanView::Above),
                front: drawn(place, PlanView::Front),
                done: ticks.iter().find(|it| it.step == step.step).cloned(),
            });
        Self {
            kind: plan.kind,
            scene: plan.scene.clone(),
            to: plan.to.clone(),
            remove: plan.remove.clone(),
            summary: plan.summary.clone(),
            shapes: shapes(plan),
            steps: steps.collect(),
        }
    }
}

impl From<StartedPlan> for StartedView {
    fn from(started: StartedPlan) -> Self {
        Self {
            shown: ShownPlan::new(&started.plan, &started.ticks),
            entry: started.entry,
        }
    }
}
