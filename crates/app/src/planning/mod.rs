//! Plans for the elements of scenes: what blocks what, and in which order they come off and go on.
//!
//! Each step of a plan is verified by the collision core with everything else in place before it is shown.

mod rows;
mod scene;
mod tables;

pub use rows::{Action, BlockersRow, LegRow, LockedRow, StepRow};
pub use scene::PlanScene;

use anyhow::bail;
use plan::{Assembly, Demands, Interference, Outcome, Planned, Planner, Sequence, Step, verified};
use serde::Serialize;

/// Answer to a question for an order.
#[derive(Debug, Clone, PartialEq)]
pub enum Planning {
    /// An order exists.
    Steps(Vec<StepRow>),
    /// Elements lock each other.
    Locked(LockedRow),
}

/// Answer to a question for a changeover.
#[derive(Debug, Clone, PartialEq)]
pub enum ChangeoverPlan {
    /// An order exists.
    Steps {
        /// What stays, goes, comes and returns.
        summary: ChangeoverRow,
        /// The steps: first those that take off, then those that put on.
        steps: Vec<StepRow>,
    },
    /// Elements of one of the scenes lock each other.
    Locked(LockedRow),
}

/// What a changeover does with each element, by ids.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ChangeoverRow {
    /// Elements that stay in place.
    pub stays: Vec<String>,
    /// Elements that come off for good.
    pub goes: Vec<String>,
    /// Elements that are new.
    pub comes: Vec<String>,
    /// Elements that come off for a while.
    pub returns: Vec<String>,
}

/// Returns the interference table of a scene, a row per element and direction.
///
/// # Errors
/// Fails when the collision core cannot decide a way.
pub fn interference(scene: &PlanScene) -> anyhow::Result<Vec<BlockersRow>> {
    let assembly = &scene.assembly;
    let tables = [
        &Interference::swept(assembly)?,
        &Interference::local(assembly)?,
        &Interference::extruded(assembly),
    ];
    Ok(rows::blockers(assembly, tables))
}

/// Plans the disassembly of a scene, or with [`Action::Add`] its assembly: the reverse.
///
/// # Errors
/// Fails on contradicting demands, and when the collision core refuses a step.
pub fn order(scene: &PlanScene, demands: &Demands, action: Action) -> anyhow::Result<Planning> {
    let planner = Planner::new(&scene.assembly, scene.priority.clone())?;
    let demands = with_groups(scene, demands);
    Ok(match planner.disassembly(&demands)? {
        Outcome::Locked(found) => Planning::Locked(rows::locked(&scene.assembly, &found)),
        Outcome::Sequence(sequence) => {
            Planning::Steps(stepped(&scene.assembly, &sequence, action, 1)?)
        }
    })
}

/// Plans the change from one scene to another.
///
/// # Errors
/// Fails on contradicting demands, and when the collision core refuses a step.
pub fn changeover(
    from: &PlanScene,
    to: &PlanScene,
    demands: &Demands,
) -> anyhow::Result<ChangeoverPlan> {
    let [before, after] =
        [from, to].map(|scene| Planner::new(&scene.assembly, scene.priority.clone()));
    let mut demands = with_groups(from, demands);
    for group in &to.groups {
        if !demands.groups.contains(group) {
            demands.groups.push(group.clone());
        }
    }
    Ok(match plan::changeover(&before?, &after?, &demands)? {
        Planned::LockedFrom(found) => ChangeoverPlan::Locked(rows::locked(&from.assembly, &found)),
        Planned::LockedTo(found) => ChangeoverPlan::Locked(rows::locked(&to.assembly, &found)),
        Planned::Changeover(found) => {
            let off = found.off.as_ref();
            let mut steps = off.map_or(Ok(Vec::new()), |sequence| {
                stepped(&from.assembly, sequence, Action::Remove, 1)
            })?;
            if let Some(sequence) = &found.on {
                let first = steps.len() + 1;
                steps.extend(stepped(&to.assembly, sequence, Action::Add, first)?);
            }
            ChangeoverPlan::Steps {
                summary: ChangeoverRow {
                    stays: found.stays,
                    goes: found.goes,
                    comes: found.comes,
                    returns: found.returns,
                },
                steps,
            }
        }
    })
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

/// Verifies a sequence and returns its rows, numbered from `first`.
fn stepped(
    assembly: &Assembly,
    sequence: &Sequence,
    action: Action,
    first: usize,
) -> anyhow::Result<Vec<StepRow>> {
    let measured = match verified(assembly, &sequence.steps)? {
        Ok(measured) => measured,
        Err(refused) => bail!(
            "step {} of the plan: the way of {} is refused, blocked by {}",
            refused.step + 1,
            assembly.id(refused.mover),
            refused
                .blocker
                .map_or("(undecidable)", |it| assembly.id(it))
        ),
    };
    let steps: Vec<Step> = match action {
        Action::Remove => sequence.steps.clone(),
        Action::Add => sequence.reversed(),
    };
    let count = steps.len();
    let numbered = steps.iter().enumerate().filter_map(|(place, step)| {
        let of_removal = match action {
            Action::Remove => place,
            Action::Add => count - 1 - place,
        };
        rows::step(assembly, first + place, action, step, &measured[of_removal])
    });
    Ok(numbered.collect())
}
