//! The search for an order with the fewest changes of direction.
//!
//! Once a direction is chosen, everything that can leave in this direction does. Leaving never blocks another unit, so
//! an order with the fewest changes exists among the orders that empty each direction before they change it. The search
//! goes level by level, a level per change, and visits each state (what is in place, last direction) once.

use crate::direction::Direction;
use crate::problem::{Problem, Taken};
use crate::remaining::Remaining;
use std::collections::HashSet;

/// Work that a level may cause, in rows of the dynamic table; bounds the states that the search keeps.
const WORK_OF_A_LEVEL: usize = 400_000;

/// Most states that the search keeps on one level.
const MOST_STATES: usize = 4096;

/// An order with few changes of direction.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FewChanges {
    pub(crate) order: Vec<Taken>,
    /// True when no order has fewer changes; false when the search has dropped states and may have missed one.
    pub(crate) is_proven: bool,
}

/// A state of the search.
#[derive(Clone)]
struct Node<'a> {
    remaining: Remaining<'a>,
    last: Option<Direction>,
    order: Vec<Taken>,
}

impl Node<'_> {
    /// Takes off, one after another, all units that can leave in this direction.
    fn along(mut self, direction: Direction) -> Self {
        self.order.extend(self.remaining.remove_along(direction));
        self.last = Some(direction);
        self
    }

    /// Takes off a unit by a way with two legs, then all units that can leave in the direction of its last leg.
    fn by(mut self, taken: Taken, last: Direction) -> Self {
        self.remaining.remove(taken.unit, |_| {});
        self.order.push(taken);
        self.along(last)
    }
}

/// Returns an order in which every unit that must leave does so, with the fewest changes found; `None` when units are
/// locked.
pub(crate) fn fewest_changes(problem: &Problem) -> Option<FewChanges> {
    let mut all = Remaining::all(problem);
    all.remove_removable();
    if all.left() > 0 {
        return None;
    }
    let most = (WORK_OF_A_LEVEL / (problem.entries() + problem.len() + 1)).clamp(6, MOST_STATES);
    let mut is_proven = true;
    let mut known: HashSet<(Box<[u64]>, Option<Direction>)> = HashSet::new();
    let mut levels: Vec<Vec<Node>> = vec![vec![Node {
        remaining: Remaining::all(problem),
        last: None,
        order: Vec::new(),
    }]];
    let mut level = 0;
    while level < levels.len() {
        let mut nodes = std::mem::take(&mut levels[level]);
        nodes.retain(|node| known.insert((node.remaining.bits(), node.last)));
        nodes.sort_by_key(|node| node.remaining.left());
        if nodes.first().is_some_and(|node| node.remaining.left() == 0) {
            let order = nodes.swap_remove(0).order;
            return Some(FewChanges { order, is_proven });
        }
        is_proven &= nodes.len() <= most;
        nodes.truncate(most);
        for node in nodes {
            for (changes, next) in followers(problem, &node) {
                let place = level + changes as usize;
                if levels.len() <= place {
                    levels.resize_with(place + 1, Vec::new);
                }
                levels[place].push(next);
            }
        }
        level += 1;
    }
    None
}

/// Returns the states that follow a state, with the number of changes that each costs.
fn followers<'a>(problem: &Problem, node: &Node<'a>) -> Vec<(u32, Node<'a>)> {
    let mut found = Vec::new();
    for direction in Direction::ALL {
        if node.last == Some(direction) {
            continue;
        }
        let next = node.clone().along(direction);
        if next.order.len() > node.order.len() {
            // The start of an order is level 0 and its first direction costs nothing; counting this direction as one
            // more change in every order keeps the levels ascending.
            found.push((1, next));
        }
    }
    for taken in node.remaining.free_two_step() {
        let way = problem.way(taken);
        if let Some(last) = way.last() {
            let first = u32::from(node.last.is_none());
            let changes = way.changes_after(node.last) + first;
            found.push((changes, node.clone().by(taken, last)));
        }
    }
    found
}
