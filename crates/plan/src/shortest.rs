//! The search for the best order of few units: of all orders with the fewest changes of direction, the shortest.
//!
//! The search goes best first over the states (what is in place, last direction). A recursion finds the fewest changes
//! from each state and remembers them; the search drops a state from which even the fewest changes exceed the least
//! number for the whole problem.

use crate::direction::Direction;
use crate::problem::{Cost, Problem, Taken};
use std::cmp::Ordering;
use std::collections::{BinaryHeap, HashMap, HashSet};

/// Most units that the search accepts.
pub(crate) const MOST_UNITS: usize = 16;

/// Most states that the search expands.
const MOST_STATES: usize = 60_000;

/// What is in place, as bits, and the direction of the last leg.
type State = (u32, Option<Direction>);

/// A way of one of the few units.
struct Choice {
    taken: Taken,
    /// Units that must be gone, as bits.
    blockers: u32,
    first: Direction,
    last: Direction,
    is_straight: bool,
    length_mm: f64,
}

/// The few units with their ways, by place.
struct Few {
    choices: Vec<Vec<Choice>>,
    /// Fewest changes from a state, as far as known; `None` when its units are locked.
    least: HashMap<State, Option<u32>>,
}

/// A state that the search has yet to expand.
struct Waiting {
    cost: Cost,
    state: State,
    /// Number of its entry in the list of steps.
    step: usize,
}

/// Returns the best order; `None` when units are locked, or when there are more than [`MOST_UNITS`] units or
/// [`MOST_STATES`] states.
pub(crate) fn best_order(problem: &Problem) -> Option<Vec<Taken>> {
    let mut few = Few::of(problem)?;
    let whole: u32 = (1_u32 << few.choices.len()) - 1;
    let fewest = few.least_changes((whole, None))?;
    let mut steps: Vec<(Taken, usize)> = Vec::new();
    let mut queue = BinaryHeap::from([Waiting {
        cost: Cost {
            changes: 0,
            length_mm: 0.0,
        },
        state: (whole, None),
        step: usize::MAX,
    }]);
    let mut done: HashSet<State> = HashSet::new();
    while let Some(now) = queue.pop() {
        let (mask, last) = now.state;
        if mask == 0 {
            let back = std::iter::successors(steps.get(now.step), |step| steps.get(step.1));
            let mut order: Vec<Taken> = back.map(|step| step.0).collect();
            order.reverse();
            return Some(order);
        }
        if !done.insert(now.state) {
            continue;
        }
        if done.len() > MOST_STATES {
            return None;
        }
        for place in 0..few.choices.len() {
            if mask >> place & 1 == 0 {
                continue;
            }
            for number in 0..few.choices[place].len() {
                let choice = &few.choices[place][number];
                if choice.blockers & mask != 0 {
                    continue;
                }
                let (taken, length_mm) = (choice.taken, choice.length_mm);
                let changes = now.cost.changes + choice.changes_after(last);
                let state = (mask & !(1 << place), Some(choice.last));
                let is_hopeful = few
                    .least_changes(state)
                    .is_some_and(|more| changes + more <= fewest);
                if is_hopeful && !done.contains(&state) {
                    steps.push((taken, now.step));
                    queue.push(Waiting {
                        cost: Cost {
                            changes,
                            length_mm: now.cost.length_mm + length_mm,
                        },
                        state,
                        step: steps.len() - 1,
                    });
                }
            }
        }
    }
    None
}

impl Choice {
    fn changes_after(&self, last: Option<Direction>) -> u32 {
        u32::from(last.is_some_and(|it| it != self.first)) + u32::from(!self.is_straight)
    }
}

impl Few {
    /// Returns the units that leave, with the ways that no staying unit blocks; `None` when there are too many.
    fn of(problem: &Problem) -> Option<Few> {
        let units: Vec<usize> = problem.leaving().collect();
        if units.len() > MOST_UNITS {
            return None;
        }
        let place = |unit: u32| units.binary_search(&(unit as usize)).ok();
        let choice = |taken: Taken| {
            let way = problem.way(taken);
            let mut blockers = 0;
            for blocker in &way.blockers {
                blockers |= 1 << place(*blocker)?;
            }
            Some(Choice {
                taken,
                blockers,
                first: way.first()?,
                last: way.last()?,
                is_straight: way.legs.len() == 1,
                length_mm: way.length_mm(),
            })
        };
        let of_unit = |unit: &usize| {
            let ways = (0..problem.ways(*unit).len()).map(|way| Taken { unit: *unit, way });
            ways.filter_map(choice).collect()
        };
        Some(Few {
            choices: units.iter().map(of_unit).collect(),
            least: HashMap::new(),
        })
    }

    /// Removes everything that can leave straight in a direction.
    fn after(&self, mut mask: u32, direction: Direction) -> u32 {
        loop {
            let before = mask;
            for (place, choices) in self.choices.iter().enumerate() {
                let is_free = |it: &Choice| {
                    it.is_straight && it.first == direction && it.blockers & mask == 0
                };
                if mask >> place & 1 == 1 && choices.iter().any(is_free) {
                    mask &= !(1 << place);
                }
            }
            if mask == before {
                return mask;
            }
        }
    }

    /// Returns the fewest changes of direction that empty a state; `None` when it cannot be emptied.
    fn least_changes(&mut self, (mask, last): State) -> Option<u32> {
        let mask = last.map_or(mask, |direction| self.after(mask, direction));
        if mask == 0 {
            return Some(0);
        }
        if let Some(known) = self.least.get(&(mask, last)) {
            return *known;
        }
        let mut least: Option<u32> = None;
        let mut offer = |found: Option<u32>, changes: u32| {
            if let Some(found) = found {
                least = Some(least.map_or(found + changes, |it| it.min(found + changes)));
            }
        };
        for direction in Direction::ALL {
            let after = self.after(mask, direction);
            if after != mask {
                let changes = u32::from(last.is_some());
                offer(self.least_changes((after, Some(direction))), changes);
            }
        }
        for place in 0..self.choices.len() {
            for number in 0..self.choices[place].len() {
                let choice = &self.choices[place][number];
                let is_free = mask >> place & 1 == 1 && choice.blockers & mask == 0;
                if is_free && !choice.is_straight {
                    let changes = choice.changes_after(last);
                    let state = (mask & !(1 << place), Some(choice.last));
                    offer(self.least_changes(state), changes);
                }
            }
        }
        self.least.insert((mask, last), least);
        least
    }
}

impl Ord for Waiting {
    /// Orders so that the cheapest state comes out of the heap first.
    fn cmp(&self, other: &Waiting) -> Ordering {
        let changes = other.cost.changes.cmp(&self.cost.changes);
        changes.then(other.cost.length_mm.total_cmp(&self.cost.length_mm))
    }
}

impl PartialOrd for Waiting {
    fn partial_cmp(&self, other: &Waiting) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Waiting {
    fn eq(&self, other: &Waiting) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Waiting {}
