//! Plans for the elements of scenes: which elements block which, and in which order they come off and go on.
//!
//! The collision core verifies each step of a plan, with everything else in place, before a person sees the plan.

mod maker;
mod rows;
mod scene;
mod steps;
mod tables;

pub use maker::ToolingPlanner;
pub use rows::{BlockersRow, LockedRow};
pub use scene::PlanScene;

use history::tooling::{ChangeoverRow, PlanAction, PlanKind, ToolingPlan};
use plan::{Demands, Interference, Outcome, Planned, Planner};
use steps::Drafted;

/// Answer to a planning question.
#[derive(Debug, Clone, PartialEq)]
pub enum Planning {
    /// A sequence of steps exists.
    Plan(Box<ToolingPlan>),
    /// No sequence exists, because these elements lock each other. In a changeover they belong to one of the two
    /// scenes.
    Locked(LockedRow),
}

/// Returns the interference table of a scene, a row per element and direction.
///
/// # Errors
/// Fails when the collision core cannot decide whether a way is clear.
pub fn interference(scene: &PlanScene) -> anyhow::Result<Vec<BlockersRow>> {
    let assembly = &scene.assembly;
    let tables = [
        &Interference::swept(assembly)?,
        &Interference::local(assembly)?,
        &Interference::extruded(assembly),
    ];
    Ok(rows::blockers(assembly, tables))
}

/// Plans the disassembly of a scene, or with [`PlanAction::Add`] its assembly, which is the reverse.
///
/// # Errors
/// Fails when `demands` contradict each other, or when the collision core refuses a step.
pub fn order(scene: &PlanScene, demands: &Demands, action: PlanAction) -> anyhow::Result<Planning> {
    let planner = Planner::new(&scene.assembly, scene.priority.clone())?;
    let kind = match action {
        PlanAction::Remove => PlanKind::Disassembly,
        PlanAction::Add => PlanKind::Assembly,
    };
    Ok(match planner.disassembly(&with_groups(scene, demands))? {
        Outcome::Locked(found) => Planning::Locked(rows::locked(&scene.assembly, &found)),
        Outcome::Sequence(sequence) => {
            let mut plan = Drafted::new(kind, &[scene]);
            plan.remove(&demands.remove);
            plan.append(&planner, &sequence, action)?;
            plan.done()
        }
    })
}

/// Plans the change from one scene to another.
///
/// # Errors
/// Fails on contradicting demands, and when the collision core refuses a step.
pub fn changeover(from: &PlanScene, to: &PlanScene, demands: &Demands) -> anyhow::Result<Planning> {
    let [before, after] =
        [from, to].map(|scene| Planner::new(&scene.assembly, scene.priority.clone()));
    let (before, after) = (before?, after?);
    let mut demands = with_groups(from, demands);
    for group in &to.groups {
        if !demands.groups.contains(group) {
            demands.groups.push(group.clone());
        }
    }
    let found = match plan::changeover(&before, &after, &demands)? {
        Planned::LockedFrom(found) => {
            return Ok(Planning::Locked(rows::locked(&from.assembly, &found)));
        }
        Planned::LockedTo(found) => {
            return Ok(Planning::Locked(rows::locked(&to.assembly, &found)));
        }
        Planned::Changeover(found) => found,
    };
    let mut plan = Drafted::new(PlanKind::Changeover, &[from, to]);
    if let Some(sequence) = &found.off {
        plan.append(&before, sequence, PlanAction::Remove)?;
    }
    if let Some(sequence) = &found.on {
        plan.append(&after, sequence, PlanAction::Add)?;
    }
    plan.summary(ChangeoverRow {
        stays: found.stays,
        goes: found.goes,
        comes: found.comes,
        returns: found.returns,
    });
    Ok(plan.done())
}

fn with_groups(scene: &PlanScene, demands: &Demands) -> Demands {
    let mut demands = demands.clone();
    let named: Vec<String> = demands.groups.concat();
    let is_new = |group: &&Vec<String>| !group.iter().any(|id| named.contains(id));
    demands
        .groups
        .extend(scene.groups.iter().filter(is_new).cloned());
    demands
}
