//! The rule of the paper: the direction in which most units can leave comes first.
//!
//! The rule takes priority directions before all others, and each direction once, until nothing more leaves in that
//! direction. The rule can end with elements in place although an order exists; the searches then take over.

use crate::direction::Direction;
use crate::problem::{Problem, Taken};
use crate::remaining::Remaining;

/// Result of the rule of the paper.
#[derive(Debug, Clone, PartialEq)]
pub struct Greedy {
    /// Units that leave, in their order.
    pub order: Vec<Taken>,
    /// Directions in the order of their use.
    pub directions: Vec<Direction>,
    /// Number of units that must leave but are still in place when the rule ends.
    pub left: usize,
}

/// Applies the rule to the priority directions, then to the others: it takes next the direction in which most units can
/// leave, and takes each direction once.
pub fn greedy(problem: &Problem, priority: &[Direction]) -> Greedy {
    let mut remaining = Remaining::all(problem);
    let mut done = Greedy {
        order: Vec::new(),
        directions: Vec::new(),
        left: 0,
    };
    let others = Direction::ALL
        .into_iter()
        .filter(|it| !priority.contains(it));
    for mut set in [priority.to_vec(), others.collect()] {
        while !set.is_empty() && remaining.left() > 0 {
            let tried = set.iter().map(|direction| {
                let mut after = remaining.clone();
                let order = after.remove_along(*direction);
                (*direction, order, after)
            });
            // Of directions in which equally many units leave, the first of the set wins.
            let best = tried.reduce(|a, b| if b.1.len() > a.1.len() { b } else { a });
            let Some((direction, order, after)) = best.filter(|it| !it.1.is_empty()) else {
                break;
            };
            set.retain(|it| *it != direction);
            done.directions.push(direction);
            done.order.extend(order);
            remaining = after;
        }
    }
    done.left = remaining.left();
    done
}
