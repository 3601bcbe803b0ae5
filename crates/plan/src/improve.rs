//! Shorter ways for an order of many units whose changes of direction are already few.
//!
//! The order is a row of runs, each in one direction. A unit may leave in another run when all blockers of that way
//! leave earlier and every unit that it blocks leaves later. Each move of a unit to a run with a shorter way shortens
//! the order and never adds a change of direction.

use crate::direction::Direction;
use crate::problem::{Problem, Taken};

/// Most passes over all units.
const MOST_PASSES: usize = 4;

/// A unit that leaves: its way and its place in the order, which lies within its run.
#[derive(Clone, Copy)]
struct Placed {
    taken: Taken,
    /// Number of the run, plus the place within the run as a fraction of 1.
    at: f64,
}

/// Returns the order with shorter ways where units can leave in another run. Orders with ways of two legs stay as they
/// are.
pub(crate) fn shortened(problem: &Problem, order: Vec<Taken>) -> Vec<Taken> {
    let is_straight = |taken: &Taken| problem.way(*taken).legs.len() == 1;
    if !order.iter().all(is_straight) {
        return order;
    }
    let mut runs: Vec<Direction> = Vec::new();
    let mut placed: Vec<Option<Placed>> = vec![None; problem.len()];
    for (index, taken) in order.iter().enumerate() {
        let direction = problem.way(*taken).last();
        if runs.last().copied() != direction {
            runs.extend(direction);
        }
        let part = (index + 1) as f64 / (order.len() + 1) as f64;
        placed[taken.unit] = Some(Placed {
            taken: *taken,
            at: (runs.len() - 1) as f64 + part,
        });
    }
    for _ in 0..MOST_PASSES {
        let mut is_better = false;
        for unit in problem.leaving() {
            if let Some(found) = better_place(problem, &placed, &runs, unit) {
                placed[unit] = Some(found);
                is_better = true;
            }
        }
        if !is_better {
            break;
        }
    }
    let mut placed: Vec<Placed> = placed.into_iter().flatten().collect();
    placed.sort_by(|a, b| a.at.total_cmp(&b.at));
    placed.into_iter().map(|it| it.taken).collect()
}

fn better_place(
    problem: &Problem,
    placed: &[Option<Placed>],
    runs: &[Direction],
    unit: usize,
) -> Option<Placed> {
    let now = placed[unit]?;
    let before = problem
        .blocked_by(unit)
        .iter()
        .filter_map(|(blocked, way)| {
            let of_blocked = placed[*blocked as usize]?;
            (of_blocked.taken.way == *way as usize).then_some(of_blocked.at)
        })
        .fold(f64::INFINITY, f64::min);
    let ways = problem.ways(unit).iter().enumerate();
    let mut best: Option<(f64, Placed)> = None;
    for (number, way) in ways {
        let least = best.map_or(problem.way(now.taken).length_mm(), |it| it.0);
        if way.legs.len() != 1 || way.length_mm() >= least {
            continue;
        }
        let after = way.blockers.iter().try_fold(0.0_f64, |latest, blocker| {
            Some(latest.max(placed[*blocker as usize]?.at))
        });
        let Some(after) = after else { continue };
        let place = runs.iter().enumerate().find_map(|(run, direction)| {
            let (low, high) = (after.max(run as f64), before.min((run + 1) as f64));
            let at = 0.5 * (low + high);
            (Some(*direction) == way.last() && at > low && at < high).then_some(at)
        });
        if let Some(at) = place {
            let taken = Taken { unit, way: number };
            best = Some((way.length_mm(), Placed { taken, at }));
        }
    }
    best.map(|it| it.1)
}
