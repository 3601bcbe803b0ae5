//! Plans a sequence that meets demands, or finds the elements that lock each other.

use crate::assembly::Assembly;
use crate::batches::fewest_changes;
use crate::demands::{Demands, Resolved};
use crate::direction::Direction;
use crate::error::PlanError;
use crate::greedy::greedy;
use crate::improve::shortened;
use crate::joint::subassembly;
use crate::locked::{locked, locked_around};
use crate::only::fewest;
use crate::problem::{Problem, Taken, Way};
use crate::remaining::Remaining;
use crate::sequence::{Method, Sequence, Step};
use crate::shortest::best_order;
use crate::table::Interference;
use crate::ways::{Units, straight, two_step};

/// Makes plans from the interference tables of an assembly.
#[derive(Debug, Clone)]
pub struct Planner<'a> {
    assembly: &'a Assembly,
    global: Interference,
    local: Interference,
    priority: Vec<Direction>,
}

/// Answer to a demand.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// An order exists.
    Sequence(Sequence),
    /// No order exists.
    Locked(LockedElements),
}

/// Elements that lock each other.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LockedElements {
    /// Numbers of the elements, in ascending order.
    pub elements: Vec<usize>,
    /// For each entry of `elements`: the elements that block its ways; each of these is locked or has to stay.
    pub by: Vec<Vec<usize>>,
    /// True when no smaller set is locked.
    pub is_smallest: bool,
}

impl<'a> Planner<'a> {
    /// Computes the tables. `priority` lists the directions that the rule of the paper tries first.
    ///
    /// # Errors
    /// Fails when the collision core cannot decide a way.
    pub fn new(assembly: &'a Assembly, priority: Vec<Direction>) -> Result<Planner<'a>, PlanError> {
        Ok(Planner {
            assembly,
            global: Interference::swept(assembly)?,
            local: Interference::local(assembly)?,
            priority,
        })
    }

    /// Returns the global interference table.
    pub fn global(&self) -> &Interference {
        &self.global
    }

    /// Returns the local constraint table.
    pub fn local(&self) -> &Interference {
        &self.local
    }

    /// Returns the assembly.
    pub fn assembly(&self) -> &'a Assembly {
        self.assembly
    }

    /// Plans the disassembly that the demands describe.
    ///
    /// # Errors
    /// Fails when a demand names an unknown element or contradicts another, or when the collision core cannot decide a
    /// way.
    pub fn disassembly(&self, demands: &Demands) -> Result<Outcome, PlanError> {
        let resolved = demands.resolved(self.assembly)?;
        let units = Units::of(&resolved.groups, self.assembly.len());
        let rests = demands.keeps_supports.then(|| self.rests(&units));
        let mut problem = self.problem(&units, &resolved, rests.as_deref());
        if !demands.straight_only {
            problem = self.with_two_steps(problem, &units, &resolved, rests.as_deref())?;
        }
        let mut wanted: Vec<usize> = resolved
            .remove
            .iter()
            .map(|element| units.of_element[*element])
            .collect();
        wanted.dedup();
        let mut is_fewest_elements = true;
        if !wanted.is_empty() {
            match fewest(&problem, &wanted) {
                Some(found) => {
                    is_fewest_elements = found.is_proven;
                    problem = problem.restricted(|unit| found.units.binary_search(&unit).is_ok());
                }
                None => return Ok(self.stuck(&problem, &units, &wanted)),
            }
        }
        let making = Making {
            units: &units,
            priority: &self.priority,
            finds_subassemblies: !demands.straight_only,
        };
        Ok(making.outcome(
            self.assembly,
            &resolved.allowed,
            &problem,
            is_fewest_elements,
        ))
    }

    fn problem(&self, units: &Units, resolved: &Resolved, rests: Option<&[Vec<u32>]>) -> Problem {
        let tables = [&self.global, &self.local];
        let mut ways = straight(self.assembly, units, &tables, &resolved.allowed);
        for (unit, of_unit) in ways.iter_mut().enumerate() {
            hold(of_unit, unit, rests);
        }
        let stays = |members: &Vec<usize>| members.iter().any(|it| resolved.stays[*it]);
        let leaves = units.members.iter().map(|members| !stays(members));
        Problem::new(ways, leaves.collect())
    }

    /// Returns the units that rest on each unit. Leaves out two units that hold each other from below: neither can wait
    /// for the other.
    fn rests(&self, units: &Units) -> Vec<Vec<u32>> {
        let held = self.held_from_below(units);
        let on = |lower: usize| {
            let rests = |upper: &u32| !held[*upper as usize].contains(&(lower as u32));
            held[lower].iter().copied().filter(rests).collect()
        };
        (0..held.len()).map(on).collect()
    }

    /// Returns, for each unit, the others that it holds from below.
    fn held_from_below(&self, units: &Units) -> Vec<Vec<u32>> {
        let mut found: Vec<Vec<u32>> = vec![Vec::new(); units.members.len()];
        for (element, upper) in units.of_element.iter().enumerate() {
            for below in self.local.blockers(element, Direction::MinusZ) {
                let lower = units.of_element[*below as usize];
                if lower != *upper && !found[lower].contains(&(*upper as u32)) {
                    found[lower].push(*upper as u32);
                }
            }
        }
        found
    }

    /// Adds two-step ways for the units that no order of straight ways frees.
    fn with_two_steps(
        &self,
        problem: Problem,
        units: &Units,
        resolved: &Resolved,
        rests: Option<&[Vec<u32>]>,
    ) -> Result<Problem, PlanError> {
        let mut remaining = Remaining::all(&problem);
        remaining.remove_removable();
        if remaining.left() == 0 {
            return Ok(problem);
        }
        let in_place = |unit: usize| remaining.is_present(unit);
        let mut more = Vec::new();
        for unit in problem.leaving().filter(|unit| in_place(*unit)) {
            let mut ways = two_step(self.assembly, units, unit, &resolved.allowed, in_place)?;
            hold(&mut ways, unit, rests);
            more.push((unit, ways));
        }
        Ok(problem.with(more))
    }

    /// Names a locked set that keeps a wanted unit in place.
    fn stuck(&self, problem: &Problem, units: &Units, wanted: &[usize]) -> Outcome {
        let mut around = wanted.iter().map(|unit| match problem.leaves(*unit) {
            true => locked_around(problem, *unit),
            false => None,
        });
        let found = around.find_map(|it| it);
        Outcome::Locked(match found {
            Some(found) => named(units, &found.units, &found.by, found.is_smallest),
            None => named(units, wanted, &[], false),
        })
    }
}

/// Lets every way of a unit wait for the units that rest on it.
fn hold(ways: &mut [Way], unit: usize, rests: Option<&[Vec<u32>]>) {
    let Some(on_unit) = rests.and_then(|it| it.get(unit)) else {
        return;
    };
    for way in ways {
        way.blockers.extend(on_unit);
        way.blockers.sort_unstable();
        way.blockers.dedup();
    }
}

fn named(units: &Units, locked: &[usize], by: &[Vec<usize>], is_smallest: bool) -> LockedElements {
    let elements_of = |unit: &usize| units.members[*unit].clone();
    let mut listed: Vec<(usize, Vec<usize>)> = Vec::new();
    for (place, unit) in locked.iter().enumerate() {
        let blockers = by.get(place).into_iter().flatten();
        let mut of_unit: Vec<usize> = blockers.flat_map(elements_of).collect();
        of_unit.sort_unstable();
        listed.extend(
            elements_of(unit)
                .into_iter()
                .map(|it| (it, of_unit.clone())),
        );
    }
    listed.sort();
    let (elements, by) = listed.into_iter().unzip();
    LockedElements {
        elements,
        by,
        is_smallest,
    }
}

/// Turns a solved problem into steps.
struct Making<'a> {
    units: &'a Units,
    priority: &'a [Direction],
    finds_subassemblies: bool,
}

/// An order for a problem that has one.
#[derive(Debug, Clone, PartialEq)]
pub struct Ordered {
    /// The units with their ways, in the order in which they leave.
    pub order: Vec<Taken>,
    /// Method that found the order.
    pub method: Method,
    /// True when no order has fewer changes of direction.
    pub is_fewest_changes: bool,
}

impl Making<'_> {
    fn outcome(
        &self,
        assembly: &Assembly,
        allowed: &[Direction],
        problem: &Problem,
        is_fewest_elements: bool,
    ) -> Outcome {
        let mut rest = problem.clone();
        let mut done = Sequence {
            steps: Vec::new(),
            method: Method::Greedy,
            is_fewest_changes: true,
            is_fewest_elements,
        };
        loop {
            let Some(stuck) = locked(&rest) else {
                self.append(&mut done, &rest, None);
                return Outcome::Sequence(done);
            };
            let before: Vec<usize> = stuck.removable.iter().map(|it| it.unit).collect();
            let core = rest.after(|unit| before.contains(&unit));
            let found = self
                .finds_subassemblies
                .then(|| {
                    subassembly(assembly, self.units, &core, allowed, |part| {
                        locked(part).is_none()
                    })
                })
                .flatten();
            let Some(found) = found else {
                return Outcome::Locked(named(
                    self.units,
                    &stuck.units,
                    &stuck.by,
                    stuck.is_smallest,
                ));
            };
            self.append(
                &mut done,
                &rest.restricted(|unit| before.contains(&unit)),
                None,
            );
            let place = done.steps.len();
            let mut elements: Vec<usize> = found
                .units
                .iter()
                .flat_map(|unit| self.units.members[*unit].iter().copied())
                .collect();
            elements.sort_unstable();
            done.steps.push(Step {
                elements,
                legs: vec![found.leg],
                bench: None,
            });
            done.is_fewest_changes = false;
            self.append(&mut done, &found.alone, Some(place));
            rest = core.after(|unit| found.units.contains(&unit));
        }
    }

    /// Appends the steps of a problem that has an order.
    fn append(&self, done: &mut Sequence, problem: &Problem, bench: Option<usize>) {
        let Some(ordered) = ordered(problem, self.priority) else {
            return;
        };
        if ordered.method == Method::Search {
            done.method = Method::Search;
        }
        done.is_fewest_changes &= ordered.is_fewest_changes;
        done.steps.extend(ordered.order.iter().map(|taken| Step {
            elements: self.units.members[taken.unit].clone(),
            legs: problem.way(*taken).legs.clone(),
            bench,
        }));
    }
}

/// Returns the cheapest order found; `None` when units are locked. For few units this is the best order; for many units
/// it is an order with few changes of direction, whose ways a search has shortened. Of two equally cheap orders,
/// returns the one that the rule of the paper gives.
pub fn ordered(problem: &Problem, priority: &[Direction]) -> Option<Ordered> {
    let found = fewest_changes(problem)?;
    let (order, is_fewest_changes) = match best_order(problem) {
        Some(best) => (best, true),
        None => (shortened(problem, found.order), found.is_proven),
    };
    let paper = greedy(problem, priority);
    let is_paper = paper.left == 0 && problem.cost(&paper.order) <= problem.cost(&order);
    Some(Ordered {
        order: if is_paper { paper.order } else { order },
        method: if is_paper {
            Method::Greedy
        } else {
            Method::Search
        },
        is_fewest_changes,
    })
}
