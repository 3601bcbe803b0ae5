//! Makes plans for the page from the scenes of the configuration.

use super::{PlanScene, Planning, changeover, order};
use anyhow::{Context, ensure};
use config::{Folder, scene_names};
use history::tooling::{PlanAction, PlanKind};
use page::{ListedScene, PlanAnswer, PlanFault, PlanMaker, PlanQuestion};
use plan::{Demands, Direction};

/// Makes plans from the scenes of a configuration.
#[derive(Debug, Clone)]
pub struct ToolingPlanner {
    folder: Folder,
}

impl ToolingPlanner {
    /// Makes a planner for the scenes of `folder`.
    pub fn new(folder: &Folder) -> ToolingPlanner {
        ToolingPlanner {
            folder: folder.clone(),
        }
    }

    fn scene(&self, name: &str) -> anyhow::Result<PlanScene> {
        let known = scene_names(&self.folder);
        ensure!(
            known.iter().any(|it| it == name),
            "scene: found {name:?}, expected one of {}",
            known.join(", ")
        );
        PlanScene::of_folder(&self.folder, name, None)
    }
}

impl PlanMaker for ToolingPlanner {
    fn scenes(&self) -> Result<Vec<ListedScene>, PlanFault> {
        let listed = |name: String| {
            let scene = self.scene(&name)?;
            let elements = scene.assembly.elements().iter();
            Ok(ListedScene {
                name,
                elements: elements.map(|it| it.id.clone()).collect(),
            })
        };
        let all = scene_names(&self.folder).into_iter().map(listed);
        all.collect::<anyhow::Result<_>>().map_err(fault)
    }

    fn make(&self, question: &PlanQuestion) -> Result<PlanAnswer, PlanFault> {
        self.planned(question).map_err(fault)
    }
}

/// Converts an error into one text with all its causes.
fn fault(error: anyhow::Error) -> PlanFault {
    PlanFault(format!("{error:#}"))
}

impl ToolingPlanner {
    fn planned(&self, question: &PlanQuestion) -> anyhow::Result<PlanAnswer> {
        let directions = question.forbid.iter().map(|it| it.parse::<Direction>());
        let demands = Demands {
            remove: question.remove.clone(),
            forbidden: directions.collect::<Result<_, _>>()?,
            ..Demands::default()
        };
        let from = self.scene(&question.scene)?;
        let planning = match question.kind {
            PlanKind::Changeover => {
                let to = question.to.as_deref();
                let to = self.scene(to.context("to: found none, expected a scene")?)?;
                changeover(&from, &to, &demands)?
            }
            PlanKind::Disassembly => order(&from, &demands, PlanAction::Remove)?,
            PlanKind::Assembly => order(&from, &demands, PlanAction::Add)?,
        };
        Ok(match planning {
            Planning::Plan(plan) => PlanAnswer::Plan(plan),
            Planning::Locked(locked) => PlanAnswer::Locked(locked.locked),
        })
    }
}
