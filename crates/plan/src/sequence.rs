//! Sequences of steps, and their reverse for assembly.

use crate::direction::Direction;
use crate::problem::{Cost, Leg};

/// One step: elements that leave, or arrive, together.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Numbers of the elements, in ascending order.
    pub elements: Vec<usize>,
    /// Straight legs in the order of the move.
    pub legs: Vec<Leg>,
    /// For a step on the bench: the index, in the disassembly, of the step in which the subassembly left as a whole.
    pub bench: Option<usize>,
}

/// Method that found a sequence.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// The rule of the paper.
    Greedy,
    /// A search over all orders, which is cheaper than the rule of the paper, or which the rule does not complete.
    Search,
}

/// Steps that take the assembly apart, in their order.
#[derive(Debug, Clone, PartialEq)]
pub struct Sequence {
    /// The steps.
    pub steps: Vec<Step>,
    /// Method that found the sequence.
    pub method: Method,
    /// True when no sequence of these ways has fewer changes of direction.
    pub is_fewest_changes: bool,
    /// True when no plan takes off fewer elements; false when the search for fewer ended early.
    pub is_fewest_elements: bool,
}

impl Sequence {
    /// Returns changes of direction and length of all ways.
    pub fn cost(&self) -> Cost {
        let legs = || self.steps.iter().flat_map(|step| &step.legs);
        let turns = legs().zip(legs().skip(1));
        let changes = turns.filter(|(a, b)| a.direction != b.direction).count();
        Cost {
            changes: changes as u32,
            length_mm: legs().map(|leg| leg.distance_mm).sum(),
        }
    }

    /// Returns the steps of the assembly: the reverse of the disassembly, each leg the way back. Places of steps in
    /// [`Step::bench`] still count from the start of the disassembly.
    pub fn reversed(&self) -> Vec<Step> {
        let back = |step: &Step| Step {
            legs: step.legs.iter().rev().map(Leg::back).collect(),
            ..step.clone()
        };
        self.steps.iter().rev().map(back).collect()
    }
}

impl Leg {
    /// Returns the way back.
    pub fn back(&self) -> Leg {
        Leg {
            direction: self.direction.opposite(),
            distance_mm: self.distance_mm,
        }
    }
}

impl Step {
    /// Returns the side from which a tool or a hand reaches the elements: where the last leg of leaving goes.
    pub fn side(&self) -> Option<Direction> {
        self.legs.last().map(|leg| leg.direction)
    }
}
