//! The global interference table: the elements that each element meets on its way out, by direction.
//!
//! Two tables are compared: [`Interference::swept`] moves the true bodies through the collision core;
//! [`Interference::extruded`] moves their boxes, as the paper does, and so blocks what a round or slanted body passes.
//!
//! **Symmetry.** An element meets another one on its way along +x exactly when the other one meets it on its way along
//! -x, because only their displacement against each other counts. So three sweeps per element fill all six rows.

use crate::assembly::Assembly;
use crate::direction::Direction;
use crate::error::PlanError;
use crate::extent::Extent;

/// How early the collision core may report a contact, mm.
const EARLY_MM: f64 = 1e-6;

/// Blockers of every element in every direction, by element numbers, each row in ascending order.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Interference {
    rows: Vec<Vec<u32>>,
}

impl Interference {
    /// Makes a table from its rows: six per element, in the order of [`Direction::ALL`].
    pub fn of_rows(rows: Vec<[Vec<u32>; 6]>) -> Interference {
        let mut rows: Vec<Vec<u32>> = rows.into_iter().flatten().collect();
        for row in &mut rows {
            row.sort_unstable();
            row.dedup();
        }
        Interference { rows }
    }

    /// Sweeps every element out of Omega in every direction and lists the elements that it meets.
    ///
    /// # Errors
    /// Fails when the collision core cannot decide a way.
    pub fn swept(assembly: &Assembly) -> Result<Interference, PlanError> {
        let mut table = mirrored(assembly, |number, direction| {
            let distance_mm = assembly.distance_out_mm(assembly.extent(number), direction);
            assembly.met(number, [0.0; 3], direction.displacement(distance_mm))
        })?;
        table.guide(assembly);
        Ok(table)
    }

    /// Moves every element a little in every direction and lists the elements that it meets: the local constraint
    /// table. The way is long enough to close a gap of `mate_mm` and to press by the contact depth.
    ///
    /// # Errors
    /// Fails when the collision core cannot decide a way.
    pub fn local(assembly: &Assembly) -> Result<Interference, PlanError> {
        let tolerance = assembly.tolerance();
        let reach_mm = tolerance.mate_mm + tolerance.contact_mm + EARLY_MM;
        let mut table = mirrored(assembly, |number, direction| {
            assembly.met(number, [0.0; 3], direction.displacement(reach_mm))
        })?;
        table.guide(assembly);
        Ok(table)
    }

    /// Extrudes the box of every element out of Omega in every direction and lists the elements whose boxes it meets
    /// deeper than the contact depth: the table of the paper.
    pub fn extruded(assembly: &Assembly) -> Interference {
        let table = mirrored(assembly, |number, direction| {
            Ok::<_, std::convert::Infallible>(extruded(assembly, number, direction))
        });
        let mut table = match table {
            Ok(table) => table,
            Err(never) => match never {},
        };
        table.guide(assembly);
        table
    }

    /// Returns the blockers of an element in a direction, in ascending order.
    pub fn blockers(&self, number: usize, direction: Direction) -> &[u32] {
        &self.rows[6 * number + direction.index()]
    }

    /// Returns the number of elements.
    pub fn len(&self) -> usize {
        self.rows.len() / 6
    }

    /// Returns true when the table has no elements.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Returns the number of entries in all rows.
    pub fn entries(&self) -> usize {
        self.rows.iter().map(Vec::len).sum()
    }

    /// Returns the heap that the table uses, bytes.
    pub fn heap_bytes(&self) -> usize {
        let entries: usize = self.rows.iter().map(Vec::capacity).sum();
        entries * size_of::<u32>() + self.rows.capacity() * size_of::<Vec<u32>>()
    }

    /// Returns the table without the pairs that `is_free` names, as for mates along their axis.
    #[must_use]
    pub fn without(mut self, is_free: impl Fn(usize, usize, Direction) -> bool) -> Interference {
        for number in 0..self.len() {
            for direction in Direction::ALL {
                let row = &mut self.rows[6 * number + direction.index()];
                row.retain(|other| !is_free(number, *other as usize, direction));
            }
        }
        self
    }

    /// Enters the guided pairs: they block each other across their axis and never along it.
    fn guide(&mut self, assembly: &Assembly) {
        for pair in assembly.guided() {
            for direction in Direction::ALL {
                let is_across = pair.axis.is_some_and(|axis| axis != direction.axis());
                for (mover, other) in [(pair.a, pair.b), (pair.b, pair.a)] {
                    let row = &mut self.rows[6 * mover + direction.index()];
                    let other = other as u32;
                    match (row.binary_search(&other), is_across) {
                        (Ok(at), false) => {
                            row.remove(at);
                        }
                        (Err(at), true) => row.insert(at, other),
                        (Ok(_), true) | (Err(_), false) => {}
                    }
                }
            }
        }
    }
}

/// Fills the rows along the axes with `row` and those against them by symmetry.
fn mirrored<E>(
    assembly: &Assembly,
    row: impl Fn(usize, Direction) -> Result<Vec<u32>, E>,
) -> Result<Interference, E> {
    let mut rows = vec![Vec::new(); 6 * assembly.len()];
    for direction in [Direction::PlusX, Direction::PlusY, Direction::PlusZ] {
        for number in 0..assembly.len() {
            let met = row(number, direction)?;
            for other in &met {
                rows[6 * *other as usize + direction.opposite().index()].push(number as u32);
            }
            rows[6 * number + direction.index()] = met;
        }
    }
    Ok(Interference { rows })
}

fn extruded(assembly: &Assembly, number: usize, direction: Direction) -> Vec<u32> {
    let own = assembly.extent(number);
    let out = direction.displacement(assembly.distance_out_mm(own, direction));
    let swept = own.joined(&own.moved(out));
    let depth_mm = assembly.tolerance().contact_mm;
    let met = |other: &Extent| {
        (0..3).all(|axis| {
            let overlap =
                swept.high[axis].min(other.high[axis]) - swept.low[axis].max(other.low[axis]);
            overlap > depth_mm
        })
    };
    (0..assembly.len())
        .filter(|other| *other != number && met(assembly.extent(*other)))
        .map(|other| other as u32)
        .collect()
}
