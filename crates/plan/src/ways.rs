//! Ways of units out of Omega: straight ones from the table, two-step ones where no straight one exists.
//!
//! A two-step way goes a distance along one direction, then out along another. The search tries the distances at which
//! a piece of the unit has just passed a piece of a blocker: for bodies made of blocks along the axes, every free
//! second leg begins at one of these distances. Round and slanted bodies have other distances too, which the search
//! does not try.

use crate::assembly::Assembly;
use crate::direction::Direction;
use crate::error::PlanError;
use crate::extent::{Extent, pieces};
use crate::problem::{Leg, Way};
use crate::table::Interference;

/// Distances that differ by less count as one, mm.
const SAME_MM: f64 = 1e-9;

/// Most distances that the search tries for the first leg of one pair of directions.
const MOST_DISTANCES: usize = 64;

/// Units of an assembly: which elements move together.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Units {
    /// Elements of each unit, in ascending order.
    pub members: Vec<Vec<usize>>,
    /// Unit of each element.
    pub of_element: Vec<usize>,
}

impl Units {
    /// Makes one unit of each group and one of each other element. No element may be in two groups.
    pub fn of(groups: &[Vec<usize>], elements: usize) -> Units {
        let mut of_element = vec![usize::MAX; elements];
        let mut members = Vec::new();
        for element in 0..elements {
            if of_element[element] != usize::MAX {
                continue;
            }
            let group = groups.iter().find(|group| group.contains(&element));
            let mut unit = group.cloned().unwrap_or_else(|| vec![element]);
            unit.sort_unstable();
            unit.dedup();
            for member in &unit {
                of_element[*member] = members.len();
            }
            members.push(unit);
        }
        Units {
            members,
            of_element,
        }
    }

    /// Returns the units of elements, without those of one unit, in ascending order.
    fn others(&self, unit: usize, elements: impl Iterator<Item = u32>) -> Vec<u32> {
        let mut units: Vec<u32> = elements
            .map(|element| self.of_element[element as usize] as u32)
            .filter(|other| *other as usize != unit)
            .collect();
        units.sort_unstable();
        units.dedup();
        units
    }

    /// Returns the box around a unit, mm.
    pub(crate) fn extent(&self, assembly: &Assembly, unit: usize) -> Extent {
        let boxes = self.members[unit].iter().map(|it| assembly.extent(*it));
        boxes.fold(Extent::NOTHING, Extent::joined)
    }
}

/// Returns the straight ways of every unit: one for each direction that is not forbidden. The blockers of a way are all
/// those that any of the tables names.
pub(crate) fn straight(
    assembly: &Assembly,
    units: &Units,
    tables: &[&Interference],
    allowed: &[Direction],
) -> Vec<Vec<Way>> {
    let way = |unit: usize, direction: Direction| {
        let members = &units.members[unit];
        let rows = members.iter().flat_map(|member| {
            tables
                .iter()
                .map(|table| table.blockers(*member, direction))
        });
        let extent = units.extent(assembly, unit);
        Way {
            legs: vec![Leg {
                direction,
                distance_mm: assembly.distance_out_mm(&extent, direction),
            }],
            blockers: units.others(unit, rows.flatten().copied()),
        }
    };
    (0..units.members.len())
        .map(|unit| allowed.iter().map(|it| way(unit, *it)).collect())
        .collect()
}

/// Returns the two-step ways of a unit; of each pair of directions, drops a way when a shorter one has no other
/// blockers among the units that `counts` selects.
///
/// # Errors
/// Fails when the collision core cannot decide a way.
pub(crate) fn two_step(
    assembly: &Assembly,
    units: &Units,
    unit: usize,
    allowed: &[Direction],
    counts: impl Fn(usize) -> bool,
) -> Result<Vec<Way>, PlanError> {
    let of_element = |element: usize| {
        let it = &assembly.elements()[element];
        pieces(&it.shape, &it.pose)
    };
    let is_obstacle = |element: &usize| {
        let other = units.of_element[*element];
        other != unit && counts(other)
    };
    let obstacles = (0..assembly.len()).filter(is_obstacle);
    let obstacles: Vec<Extent> = obstacles.flat_map(of_element).collect();
    let own: Vec<Extent> = units.members[unit]
        .iter()
        .flat_map(|element| of_element(*element))
        .collect();
    let around = units.extent(assembly, unit);
    let mut found = Vec::new();
    for first in allowed {
        let out_mm = assembly.distance_out_mm(&around, *first);
        let distances = passing_mm(&own, &obstacles, *first, out_mm);
        for second in allowed.iter().filter(|it| it.axis() != first.axis()) {
            let mut of_pair: Vec<Way> = Vec::new();
            for distance_mm in &distances {
                let legs = [
                    Leg {
                        direction: *first,
                        distance_mm: *distance_mm,
                    },
                    Leg {
                        direction: *second,
                        distance_mm: assembly.distance_out_mm(&around, *second),
                    },
                ];
                let blockers = along(assembly, units, unit, &legs)?;
                let left = |way: &Way| -> Vec<u32> {
                    let counted = way.blockers.iter().filter(|it| counts(**it as usize));
                    counted.copied().collect()
                };
                let way = Way {
                    legs: legs.to_vec(),
                    blockers,
                };
                let wanted = left(&way);
                // Distances ascend, so no known way is longer than this one.
                let is_known = |it: &Way| left(it).iter().all(|one| wanted.contains(one));
                if !of_pair.iter().any(is_known) {
                    of_pair.push(way);
                }
            }
            found.extend(of_pair);
        }
    }
    Ok(found)
}

/// Returns the units that a unit meets along legs that follow each other.
fn along(
    assembly: &Assembly,
    units: &Units,
    unit: usize,
    legs: &[Leg],
) -> Result<Vec<u32>, PlanError> {
    let mut met = Vec::new();
    for member in &units.members[unit] {
        let mut from = [0.0; 3];
        for leg in legs {
            let by = leg.direction.displacement(leg.distance_mm);
            met.extend(assembly.met(*member, from, by)?);
            met.extend(assembly.guiding(*member, leg.direction));
            from = [0, 1, 2].map(|axis| from[axis] + by[axis]);
        }
    }
    Ok(units.others(unit, met.into_iter()))
}

/// Returns the distances after which a piece of the unit has just passed a piece of an obstacle, ascending, mm.
fn passing_mm(own: &[Extent], obstacles: &[Extent], direction: Direction, out_mm: f64) -> Vec<f64> {
    let axis = direction.axis();
    let mut distances = Vec::new();
    for piece in own {
        for obstacle in obstacles {
            let distance_mm = if direction.sign() > 0.0 {
                obstacle.high[axis] - piece.low[axis]
            } else {
                piece.high[axis] - obstacle.low[axis]
            };
            if distance_mm > 0.0 && distance_mm < out_mm {
                distances.push(distance_mm);
            }
        }
    }
    distances.sort_by(f64::total_cmp);
    distances.dedup_by(|later, earlier| *later - *earlier < SAME_MM);
    distances.truncate(MOST_DISTANCES);
    distances
}
