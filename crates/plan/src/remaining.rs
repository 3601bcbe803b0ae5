//! The dynamic table: how many blockers of every way are still in place, kept up to date as units leave.
//!
//! A unit that leaves touches exactly the rows in which it is a blocker; [`Remaining::touched`] counts them.

use crate::direction::Direction;
use crate::problem::{Problem, Taken};

/// Units that are still in place, with the number of blockers left in every way.
#[derive(Debug, Clone)]
pub struct Remaining<'a> {
    problem: &'a Problem,
    is_present: Vec<bool>,
    /// By number of the way in the whole problem.
    counts: Vec<u32>,
    touched: usize,
    left: usize,
}

impl<'a> Remaining<'a> {
    /// Starts with every unit in place.
    pub fn all(problem: &'a Problem) -> Remaining<'a> {
        let ways = (0..problem.len()).flat_map(|unit| problem.ways(unit));
        Remaining {
            problem,
            is_present: vec![true; problem.len()],
            counts: ways.map(|way| way.blockers.len() as u32).collect(),
            touched: 0,
            left: problem.leaving().count(),
        }
    }

    /// Returns the number of units that still have to leave.
    pub fn left(&self) -> usize {
        self.left
    }

    /// Returns true when the unit is in place.
    pub fn is_present(&self, unit: usize) -> bool {
        self.is_present[unit]
    }

    /// Returns the number of rows that removals have touched since the start.
    pub fn touched(&self) -> usize {
        self.touched
    }

    /// Returns true when the unit can leave on this way now.
    pub fn is_free(&self, taken: Taken) -> bool {
        self.is_present[taken.unit] && self.blockers_left(taken) == 0
    }

    /// Returns the number of blockers of a way that are still in place.
    pub fn blockers_left(&self, taken: Taken) -> usize {
        self.counts[self.problem.way_number(taken)] as usize
    }

    /// Removes a unit, whether it is free or not, and calls `freed` for every way that loses its last blocker.
    pub fn remove(&mut self, unit: usize, mut freed: impl FnMut(Taken)) {
        if !std::mem::replace(&mut self.is_present[unit], false) {
            return;
        }
        self.left -= usize::from(self.problem.leaves(unit));
        for (blocked, way) in self.problem.blocked_by(unit) {
            let taken = Taken {
                unit: *blocked as usize,
                way: *way as usize,
            };
            let count = &mut self.counts[self.problem.way_number(taken)];
            *count -= 1;
            self.touched += 1;
            if *count == 0 && self.is_present[taken.unit] {
                freed(taken);
            }
        }
    }

    /// Returns the free ways that `wanted` accepts, at most one per unit.
    fn free(&self, wanted: &impl Fn(Taken) -> bool) -> Vec<Taken> {
        let of_unit = |unit: usize| {
            let ways = (0..self.problem.ways(unit).len()).map(move |way| Taken { unit, way });
            let mut free = ways.filter(|it| self.is_free(*it) && wanted(*it));
            free.next()
        };
        let present = self.problem.leaving().filter(|unit| self.is_present[*unit]);
        present.filter_map(of_unit).collect()
    }

    /// Removes every unit that can leave on ways that `wanted` accepts, also those that others free by leaving, and
    /// returns them in their order.
    fn remove_all(&mut self, wanted: impl Fn(Taken) -> bool) -> Vec<Taken> {
        let mut order = self.free(&wanted);
        let mut next = 0;
        let mut is_listed = vec![false; self.problem.len()];
        order.iter().for_each(|taken| is_listed[taken.unit] = true);
        while let Some(taken) = order.get(next).copied() {
            next += 1;
            self.remove(taken.unit, |freed| {
                if wanted(freed) && !std::mem::replace(&mut is_listed[freed.unit], true) {
                    order.push(freed);
                }
            });
        }
        order
    }

    /// Removes every unit that can leave straight in one direction and returns them in their order.
    pub fn remove_along(&mut self, direction: Direction) -> Vec<Taken> {
        let problem = self.problem;
        self.remove_all(|taken| {
            let legs = &problem.way(taken).legs;
            legs.len() == 1 && legs[0].direction == direction
        })
    }

    /// Removes every unit that can leave on any way and returns them in their order. Units that are left then are
    /// locked.
    pub fn remove_removable(&mut self) -> Vec<Taken> {
        self.remove_all(|_| true)
    }

    /// Returns the free ways with two legs.
    pub fn free_two_step(&self) -> Vec<Taken> {
        let leaving = self.problem.leaving();
        let ways = leaving.flat_map(|unit| {
            let count = self.problem.ways(unit).len();
            (0..count).map(move |way| Taken { unit, way })
        });
        ways.filter(|it| self.problem.way(*it).legs.len() > 1 && self.is_free(*it))
            .collect()
    }

    /// Returns which units are in place, as bits.
    pub fn bits(&self) -> Box<[u64]> {
        let mut bits = vec![0_u64; self.is_present.len().div_ceil(64)];
        for (unit, present) in self.is_present.iter().enumerate() {
            bits[unit / 64] |= u64::from(*present) << (unit % 64);
        }
        bits.into()
    }
}
