//! The best order by brute force: every order and every direction, asked of the collision core with exactly what is
//! still in place. It shares no table with the planner.
use super::*;
use lpm::{ElementKey, Model, Mover, Passing, Permission};
use std::borrow::Cow;
use std::collections::HashMap;

pub(super) struct Brute<'a> {
    assembly: &'a Assembly,
    known: HashMap<(u32, usize, usize), bool>,
    best: HashMap<(u32, Option<Direction>), Option<Cost>>,
}

impl Brute<'_> {
    pub(super) fn of(assembly: &Assembly) -> Brute<'_> {
        Brute {
            assembly,
            known: HashMap::new(),
            best: HashMap::new(),
        }
    }

    /// Returns true when an element can leave while exactly the elements of `mask` are in place.
    pub(super) fn is_free(&mut self, mask: u32, number: usize, direction: Direction) -> bool {
        let assembly = self.assembly;
        let key = (mask, number, direction.index());
        *self
            .known
            .entry(key)
            .or_insert_with(|| asked(assembly, mask, number, direction))
    }

    /// Returns the cost of the best of all orders; `None` when there is none.
    pub(super) fn best(&mut self, mask: u32, last: Option<Direction>) -> Option<Cost> {
        if mask == 0 {
            return Some(Cost {
                changes: 0,
                length_mm: 0.0,
            });
        }
        if let Some(known) = self.best.get(&(mask, last)) {
            return *known;
        }
        let mut best: Option<Cost> = None;
        for number in 0..self.assembly.len() {
            for direction in Direction::ALL {
                if mask >> number & 1 == 0 || !self.is_free(mask, number, direction) {
                    continue;
                }
                if let Some(rest) = self.best(mask & !(1 << number), Some(direction)) {
                    let extent = self.assembly.extent(number);
                    let cost = Cost {
                        changes: rest.changes + u32::from(last.is_some_and(|it| it != direction)),
                        length_mm: rest.length_mm
                            + self.assembly.distance_out_mm(extent, direction),
                    };
                    best = Some(best.map_or(cost, |it| if cost < it { cost } else { it }));
                }
            }
        }
        self.best.insert((mask, last), best);
        best
    }

    /// Returns true when no element of the set can leave while exactly this set is in place.
    pub(super) fn is_locked(&mut self, elements: &[usize]) -> bool {
        let mask = elements.iter().fold(0, |mask, it| mask | 1 << it);
        let mut each = elements.iter();
        !elements.is_empty()
            && each.all(|it| {
                Direction::ALL
                    .iter()
                    .all(|way| !self.is_free(mask, *it, *way))
            })
    }
}

fn asked(assembly: &Assembly, mask: u32, number: usize, direction: Direction) -> bool {
    let mut model = Model::new();
    let depth_mm = assembly.tolerance().contact_mm;
    let touch = Permission::MayTouch { depth_mm };
    let mut permissions: Vec<(ElementKey, Permission)> = Vec::new();
    for (other, it) in assembly.elements().iter().enumerate() {
        if other != number && mask >> other & 1 == 1 {
            let key = model.insert(&it.id, &it.shape, &it.pose).unwrap();
            permissions.push((key, touch));
        }
    }
    let own = &assembly.elements()[number];
    let distance_mm = assembly.distance_out_mm(assembly.extent(number), direction);
    let by = direction.displacement(distance_mm);
    let to = [0, 1, 2].map(|axis| own.pose.position[axis] + by[axis]);
    let found = model.first_forbidden(&permissions, |depth_mm| {
        Ok(Passing {
            mover: Cow::Owned(Mover::new(&own.shape.less(depth_mm))?),
            from: own.pose,
            to: own.pose.moved_to(to),
        })
    });
    found.unwrap().is_none()
}
