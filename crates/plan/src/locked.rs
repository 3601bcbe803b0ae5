//! Sets of units that lock each other, when no order exists.
//!
//! A set is locked when another unit of the set, or a unit that stays, blocks every way of every unit of the set. The
//! largest locked set remains when everything removable has gone; a smallest locked set inside it shows what to change.

use crate::problem::{Problem, Taken};
use crate::remaining::Remaining;

/// Largest set of which the search tries all smaller sets.
const MOST_TRIED: usize = 14;

/// Units that lock each other.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Locked {
    /// The units, in ascending order; each has to leave and none can.
    pub units: Vec<usize>,
    /// For each unit of the set: the units that block its ways; each is in the set or stays.
    pub by: Vec<Vec<usize>>,
    /// Units that can leave before the rest is stuck, in their order.
    pub removable: Vec<Taken>,
    /// True when no smaller set is locked; false when only the parts of this set are known not to be locked.
    pub is_smallest: bool,
}

/// Returns a smallest locked set; `None` when everything that has to leave can leave.
pub fn locked(problem: &Problem) -> Option<Locked> {
    let mut remaining = Remaining::all(problem);
    let removable = remaining.remove_removable();
    let core: Vec<usize> = problem
        .leaving()
        .filter(|unit| remaining.is_present(*unit))
        .collect();
    if core.is_empty() {
        return None;
    }
    let is_smallest = core.len() <= MOST_TRIED;
    let units = if is_smallest {
        smallest(problem, &core)
    } else {
        least_part(problem, core, None)
    };
    let by = units.iter().map(|unit| lockers(problem, &units, *unit));
    Some(Locked {
        by: by.collect(),
        units,
        removable,
        is_smallest,
    })
}

/// Returns a locked set that contains the unit and has no smaller locked part with it; `None` when the unit can leave.
pub fn locked_around(problem: &Problem, unit: usize) -> Option<Locked> {
    let mut remaining = Remaining::all(problem);
    let removable = remaining.remove_removable();
    let is_left = |it: &usize| remaining.is_present(*it);
    let core: Vec<usize> = problem.leaving().filter(is_left).collect();
    core.binary_search(&unit).ok()?;
    let units = least_part(problem, core, Some(unit));
    let by = units.iter().map(|it| lockers(problem, &units, *it));
    Some(Locked {
        by: by.collect(),
        units,
        removable,
        is_smallest: false,
    })
}

/// Returns true when another unit of the set, or a unit that stays, blocks each way of each unit.
pub fn is_locked(problem: &Problem, units: &[usize]) -> bool {
    let is_blocked = |unit: &usize| {
        let mut ways = problem.ways(*unit).iter();
        ways.all(|way| way.blockers.iter().any(|it| holds(problem, units, *it)))
    };
    !units.is_empty() && units.iter().all(is_blocked)
}

fn holds(problem: &Problem, units: &[usize], blocker: u32) -> bool {
    let blocker = blocker as usize;
    !problem.leaves(blocker) || units.binary_search(&blocker).is_ok()
}

fn lockers(problem: &Problem, units: &[usize], unit: usize) -> Vec<usize> {
    let ways = problem.ways(unit).iter();
    let blockers = ways.flat_map(|way| way.blockers.iter().copied());
    let mut found: Vec<usize> = blockers
        .filter(|blocker| holds(problem, units, *blocker))
        .map(|blocker| blocker as usize)
        .collect();
    found.sort_unstable();
    found.dedup();
    found
}

/// Tries the parts of a set, the small ones first.
fn smallest(problem: &Problem, core: &[usize]) -> Vec<usize> {
    let part = |mask: u32| -> Vec<usize> {
        let places = (0..core.len()).filter(|place| mask >> place & 1 == 1);
        places.map(|place| core[place]).collect()
    };
    let mut masks: Vec<u32> = (1..1_u32 << core.len()).collect();
    masks.sort_by_key(|mask| mask.count_ones());
    let found = masks
        .into_iter()
        .map(part)
        .find(|it| is_locked(problem, it));
    found.unwrap_or_else(|| core.to_vec())
}

/// Takes one unit after the other out of a set, as long as a locked part is left, with `wanted` in it.
fn least_part(problem: &Problem, core: Vec<usize>, wanted: Option<usize>) -> Vec<usize> {
    let mut kept = core.clone();
    for unit in core {
        let without: Vec<usize> = kept.iter().copied().filter(|it| *it != unit).collect();
        let rest = locked_part(problem, without);
        let is_kept = wanted.is_none_or(|it| rest.binary_search(&it).is_ok());
        if !rest.is_empty() && is_kept {
            kept = rest;
        }
    }
    kept
}

/// Returns the largest locked part of a set; empty when there is none.
fn locked_part(problem: &Problem, mut units: Vec<usize>) -> Vec<usize> {
    loop {
        let is_stuck = |unit: &usize| {
            let mut ways = problem.ways(*unit).iter();
            ways.all(|way| way.blockers.iter().any(|it| holds(problem, &units, *it)))
        };
        let rest: Vec<usize> = units.iter().copied().filter(|it| is_stuck(it)).collect();
        if rest.len() == units.len() {
            return rest;
        }
        units = rest;
    }
}
