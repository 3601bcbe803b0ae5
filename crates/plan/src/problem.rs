//! The combinatorial part of a plan: units, their ways out, and what stands in each way.
//!
//! A unit is an element, or a group of elements that moves as one. Whether a way is free depends only on which of its
//! blockers are still in place, so a table of blockers decides every order without another sweep. An element that has
//! left never comes back into a way: removing a unit can free others and can block none.

use crate::direction::Direction;

/// A straight part of a way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leg {
    /// Direction of the move.
    pub direction: Direction,
    /// Length of the move, mm, >= 0.
    pub distance_mm: f64,
}

/// A way of a unit out of Omega, with everything that blocks it.
#[derive(Debug, Clone, PartialEq)]
pub struct Way {
    /// One straight leg, or two.
    pub legs: Vec<Leg>,
    /// Units that stand in the way, in ascending order.
    pub blockers: Vec<u32>,
}

impl Way {
    /// Returns the length of all legs, mm.
    pub fn length_mm(&self) -> f64 {
        self.legs.iter().map(|leg| leg.distance_mm).sum()
    }

    /// Returns the direction of the first leg.
    pub fn first(&self) -> Option<Direction> {
        self.legs.first().map(|leg| leg.direction)
    }

    /// Returns the direction of the last leg.
    pub fn last(&self) -> Option<Direction> {
        self.legs.last().map(|leg| leg.direction)
    }

    /// Returns the number of changes of direction that this way adds after a leg in the direction `before`.
    pub fn changes_after(&self, before: Option<Direction>) -> u32 {
        let mut known = before;
        let mut changes = 0;
        for leg in &self.legs {
            changes += u32::from(known.is_some_and(|it| it != leg.direction));
            known = Some(leg.direction);
        }
        changes
    }
}

/// Units with their ways, and which of them have to leave.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    ways: Vec<Vec<Way>>,
    leaves: Vec<bool>,
    /// By unit: the number of its first way among the ways of all units.
    starts: Vec<u32>,
    /// By unit: the ways that it blocks, each as a unit and the number of one of its ways.
    blocks: Vec<Vec<(u32, u32)>>,
}

/// A unit that leaves, with the number of the way that it takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Taken {
    /// Number of the unit.
    pub unit: usize,
    /// Number of the way among the ways of the unit.
    pub way: usize,
}

/// Cost of an order: fewer changes of direction come first, then shorter ways.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct Cost {
    /// Number of legs whose direction differs from that of the leg before.
    pub changes: u32,
    /// Length of all ways, mm.
    pub length_mm: f64,
}

impl Problem {
    /// Makes a problem; `leaves` says which units have to leave, the others stay where they are. Drops the ways of
    /// units that stay.
    pub fn new(mut ways: Vec<Vec<Way>>, leaves: Vec<bool>) -> Problem {
        let mut blocks = vec![Vec::new(); ways.len()];
        let mut starts = Vec::with_capacity(ways.len());
        let mut known = 0;
        for (unit, of_unit) in ways.iter_mut().enumerate() {
            if !leaves[unit] {
                of_unit.clear();
            }
            starts.push(known);
            known += of_unit.len() as u32;
            for (number, way) in of_unit.iter().enumerate() {
                for blocker in &way.blockers {
                    blocks[*blocker as usize].push((unit as u32, number as u32));
                }
            }
        }
        Problem {
            ways,
            leaves,
            starts,
            blocks,
        }
    }

    /// Returns the number of units.
    pub fn len(&self) -> usize {
        self.ways.len()
    }

    /// Returns true when there are no units.
    pub fn is_empty(&self) -> bool {
        self.ways.is_empty()
    }

    /// Returns the ways of a unit; none for a unit that stays.
    pub fn ways(&self, unit: usize) -> &[Way] {
        &self.ways[unit]
    }

    /// Returns true when the unit has to leave.
    pub fn leaves(&self, unit: usize) -> bool {
        self.leaves[unit]
    }

    /// Returns the units that have to leave, in ascending order.
    pub fn leaving(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.len()).filter(|unit| self.leaves[*unit])
    }

    /// Returns the ways, as unit and number of the way, that a unit blocks.
    pub(crate) fn blocked_by(&self, unit: usize) -> &[(u32, u32)] {
        &self.blocks[unit]
    }

    /// Returns the number of a way among the ways of all units.
    pub(crate) fn way_number(&self, taken: Taken) -> usize {
        self.starts[taken.unit] as usize + taken.way
    }

    /// Returns the number of blockers in all ways.
    pub fn entries(&self) -> usize {
        self.blocks.iter().map(Vec::len).sum()
    }

    /// Returns the way that an entry of an order takes.
    pub fn way(&self, taken: Taken) -> &Way {
        &self.ways[taken.unit][taken.way]
    }

    /// Returns the problem in which only the units that `leaves` names have to leave.
    #[must_use]
    pub fn restricted(&self, leaves: impl Fn(usize) -> bool) -> Problem {
        let wanted = (0..self.len()).map(|unit| self.leaves[unit] && leaves(unit));
        Problem::new(self.ways.clone(), wanted.collect())
    }

    /// Returns the problem after the units that `is_gone` names have left.
    #[must_use]
    pub fn after(&self, is_gone: impl Fn(usize) -> bool) -> Problem {
        let mut ways = self.ways.clone();
        for way in ways.iter_mut().flatten() {
            way.blockers.retain(|blocker| !is_gone(*blocker as usize));
        }
        let leaves = (0..self.len()).map(|unit| self.leaves[unit] && !is_gone(unit));
        Problem::new(ways, leaves.collect())
    }

    /// Returns the problem with more ways for some units.
    #[must_use]
    pub fn with(&self, more: Vec<(usize, Vec<Way>)>) -> Problem {
        let mut ways = self.ways.clone();
        for (unit, of_unit) in more {
            ways[unit].extend(of_unit);
        }
        Problem::new(ways, self.leaves.clone())
    }

    /// Returns the cost of an order.
    pub fn cost(&self, order: &[Taken]) -> Cost {
        let mut last = None;
        let mut cost = Cost {
            changes: 0,
            length_mm: 0.0,
        };
        for taken in order {
            let way = self.way(*taken);
            cost.changes += way.changes_after(last);
            cost.length_mm += way.length_mm();
            last = way.last().or(last);
        }
        cost
    }

    /// Returns the place in the order of the first step that is blocked, with a blocker; `None` when all steps are
    /// free and every unit that has to leave does so once.
    pub fn first_fault(&self, order: &[Taken]) -> Option<(usize, Option<usize>)> {
        let mut is_gone = vec![false; self.len()];
        for (place, taken) in order.iter().enumerate() {
            let way = self.way(*taken);
            let blocker = way.blockers.iter().find(|it| !is_gone[**it as usize]);
            if let Some(blocker) = blocker {
                return Some((place, Some(*blocker as usize)));
            }
            if std::mem::replace(&mut is_gone[taken.unit], true) {
                return Some((place, None));
            }
        }
        let is_done = self.leaving().all(|unit| is_gone[unit]);
        (!is_done).then_some((order.len(), None))
    }
}
