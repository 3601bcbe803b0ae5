//! Subassemblies: units that lock each other in place, and leave together to be taken apart on the bench.
//!
//! A unit can leave in a direction together with everything that blocks it in this direction, everything that blocks
//! these blockers, and so on. The planner uses the smallest such set that can be taken apart on its own.

use crate::assembly::Assembly;
use crate::direction::Direction;
use crate::extent::Extent;
use crate::problem::{Leg, Problem};
use crate::ways::Units;

/// Units that leave together.
#[derive(Debug, Clone)]
pub(crate) struct Subassembly {
    /// The units, in ascending order.
    pub(crate) units: Vec<usize>,
    /// The common way of the units.
    pub(crate) leg: Leg,
    /// The problem of taking the subassembly apart on the bench.
    pub(crate) alone: Problem,
}

/// Returns the smallest subassembly that can leave as a whole although its units cannot leave alone, and for whose
/// problem `has_order` returns true; `None` when there is none.
pub(crate) fn subassembly(
    assembly: &Assembly,
    units: &Units,
    core: &Problem,
    allowed: &[Direction],
    has_order: impl Fn(&Problem) -> bool,
) -> Option<Subassembly> {
    let mut candidates: Vec<(Vec<usize>, Direction)> = Vec::new();
    for direction in allowed {
        for unit in core.leaving() {
            if let Some(found) = closed(core, unit, *direction) {
                candidates.push((found, *direction));
            }
        }
    }
    candidates.sort_by_key(|it| (it.0.len(), it.0.clone(), it.1));
    candidates.dedup();
    let usable = candidates.into_iter().filter(|it| it.0.len() > 1);
    let mut made = usable.map(|(together, direction)| {
        let around = together
            .iter()
            .map(|unit| units.extent(assembly, *unit))
            .fold(Extent::NOTHING, |all, one| all.joined(&one));
        Subassembly {
            leg: Leg {
                direction,
                distance_mm: assembly.distance_out_mm(&around, direction),
            },
            alone: core.after(|unit| together.binary_search(&unit).is_err()),
            units: together,
        }
    });
    made.find(|it| has_order(&it.alone))
}

/// Returns the unit with all units that have to leave with it in a direction; `None` when one of them stays.
fn closed(core: &Problem, unit: usize, direction: Direction) -> Option<Vec<usize>> {
    let mut found = vec![unit];
    let mut next = 0;
    while let Some(unit) = found.get(next).copied() {
        next += 1;
        let straight = |legs: &[Leg]| legs.len() == 1 && legs[0].direction == direction;
        let way = core.ways(unit).iter().find(|way| straight(&way.legs))?;
        for blocker in &way.blockers {
            let blocker = *blocker as usize;
            if !core.leaves(blocker) {
                return None;
            }
            if !found.contains(&blocker) {
                found.push(blocker);
            }
        }
    }
    found.sort_unstable();
    Some(found)
}
