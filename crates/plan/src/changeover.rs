//! Plans the change from one assembly to another: what stays, goes and comes, in order.
//!
//! An element with the same id, shape and place in both assemblies stays, unless it must come off for a while so that
//! others can go or come. An element that comes off one assembly for that reason comes off the other one too; the
//! planner plans the two sides in turns until they agree.

use crate::assembly::{Assembly, Element};
use crate::demands::Demands;
use crate::error::PlanError;
use crate::planner::{LockedElements, Outcome, Planner};
use crate::sequence::Sequence;
use std::collections::BTreeSet;

/// A plan that leads from one assembly to another.
#[derive(Debug, Clone, PartialEq)]
pub struct Changeover {
    /// Ids that stay in place, in the order of the first assembly.
    pub stays: Vec<String>,
    /// Ids that come off for good, sorted; an element that moves to another place goes and comes.
    pub goes: Vec<String>,
    /// Ids that are new, sorted.
    pub comes: Vec<String>,
    /// Ids that come off for a while and go back to their place, sorted.
    pub returns: Vec<String>,
    /// Disassembly of the first assembly, with its element numbers; `None` when nothing comes off.
    pub off: Option<Sequence>,
    /// Disassembly of the second assembly; its reverse puts this assembly together. Element numbers are those of the
    /// second assembly.
    pub on: Option<Sequence>,
}

/// Result of planning a changeover.
#[derive(Debug, Clone, PartialEq)]
pub enum Planned {
    /// An order exists.
    Changeover(Box<Changeover>),
    /// Elements of the first assembly lock each other.
    LockedFrom(LockedElements),
    /// Elements of the second assembly lock each other, so the second assembly cannot be put together.
    LockedTo(LockedElements),
}

/// Plans the change from the assembly of one planner to that of another. `demands` gives what stays, the groups and the
/// forbidden directions; an id that only one assembly has applies to that assembly.
///
/// # Errors
/// Fails as [`Planner::disassembly`] does, and when a demand names an id that neither assembly has.
pub fn changeover(from: &Planner, to: &Planner, demands: &Demands) -> Result<Planned, PlanError> {
    let goes = differing(from.assembly(), to.assembly());
    let comes = differing(to.assembly(), from.assembly());
    let mut returns: BTreeSet<String> = BTreeSet::new();
    loop {
        let off = match side(from, demands, &goes, &returns, to)? {
            Ok(off) => off,
            Err(locked) => return Ok(Planned::LockedFrom(locked)),
        };
        let on = match side(to, demands, &comes, &returns, from)? {
            Ok(on) => on,
            Err(locked) => return Ok(Planned::LockedTo(locked)),
        };
        let mut needed = returns.clone();
        for (planner, sequence, wanted) in [(from, &off, &goes), (to, &on, &comes)] {
            let steps = sequence.iter().flat_map(|it| &it.steps);
            let ids = steps.flat_map(|step| &step.elements);
            let ids = ids.map(|it| planner.assembly().id(*it).to_owned());
            needed.extend(ids.filter(|id| !wanted.contains(id)));
        }
        // The set only grows and is bounded by the common elements, so the loop ends.
        if needed == returns {
            let elements = from.assembly().elements().iter();
            let stays = elements
                .map(|it| it.id.clone())
                .filter(|id| !goes.contains(id) && !returns.contains(id));
            return Ok(Planned::Changeover(Box::new(Changeover {
                stays: stays.collect(),
                goes: goes.into_iter().collect(),
                comes: comes.into_iter().collect(),
                returns: returns.into_iter().collect(),
                off,
                on,
            })));
        }
        returns = needed;
    }
}

/// Returns the ids of `one` that `other` does not have in the same shape and place.
fn differing(one: &Assembly, other: &Assembly) -> BTreeSet<String> {
    let twin = |element: &Element| {
        let number = other.number(&element.id, "changeover").ok()?;
        let found = &other.elements()[number];
        (found.shape == element.shape && found.pose == element.pose).then_some(())
    };
    let elements = one.elements().iter();
    let differing = elements.filter(|it| twin(it).is_none());
    differing.map(|it| it.id.clone()).collect()
}

/// Plans the disassembly of one of the two assemblies; `None` when nothing has to come off.
fn side(
    planner: &Planner,
    demands: &Demands,
    wanted: &BTreeSet<String>,
    returns: &BTreeSet<String>,
    other: &Planner,
) -> Result<Result<Option<Sequence>, LockedElements>, PlanError> {
    let remove: Vec<String> = wanted.iter().chain(returns).cloned().collect();
    if remove.is_empty() {
        return Ok(Ok(None));
    }
    // An id that only the other assembly has does not apply to this one.
    let known = |id: &String| is_named(planner, id) || !is_named(other, id);
    let mut of_side = Demands {
        remove,
        ..demands.clone()
    };
    of_side.stay.retain(known);
    for group in &mut of_side.groups {
        group.retain(known);
    }
    of_side.groups.retain(|group| !group.is_empty());
    Ok(match planner.disassembly(&of_side)? {
        Outcome::Sequence(sequence) => Ok(Some(sequence)),
        Outcome::Locked(locked) => Err(locked),
    })
}

fn is_named(planner: &Planner, id: &str) -> bool {
    let mut elements = planner.assembly().elements().iter();
    match id.strip_suffix('*') {
        Some(stem) => elements.any(|it| it.id.starts_with(stem)),
        None => elements.any(|it| it.id == id),
    }
}
