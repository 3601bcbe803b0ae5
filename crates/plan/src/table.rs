//! The global interference table: the elements that each element meets on its way out, by direction.
//!
//! The library makes two tables to compare: [`Interference::swept`] moves the true bodies through the collision core;
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
    /// Index in `entries` at which each row begins, and the end of the last row.
    starts: Vec<u32>,
    entries: Vec<u32>,
}

impl Interference {
    /// Makes a table from its rows: six per element, in the order of [`Direction::ALL`].
    pub fn of_rows(rows: Vec<[Vec<u32>; 6]>) -> Interference {
        let rows = rows.into_iter().flatten().map(|mut row| {
            row.sort_unstable();
            row.dedup();
            row
        });
        Interference::joined(rows)
    }

    fn joined(rows: impl Iterator<Item = Vec<u32>>) -> Interference {
        let mut table = Interference {
            starts: vec![0],
            entries: Vec::new(),
        };
        for row in rows {
            table.entries.extend(row);
            table.starts.push(table.entries.len() as u32);
        }
        table
    }

    /// Sweeps every element out of Omega in every direction and lists the elements that it meets.
    ///
    /// # Errors
    /// Fails when the collision core cannot decide a way.
    pub fn swept(assembly: &Assembly) -> Result<Interference, PlanError> {
        moved(assembly, |number, direction| {
            assembly.distance_out_mm(assembly.extent(number), direction)
        })
    }

    /// Moves every element a little in every direction and lists the elements that it meets: the local constraint
    /// table. The way is long enough to close a gap of `mate_mm` and to press by the contact depth.
    ///
    /// # Errors
    /// Fails when the collision core cannot decide a way.
    pub fn local(assembly: &Assembly) -> Result<Interference, PlanError> {
        let tolerance = assembly.tolerance();
        let reach_mm = tolerance.mate_mm + tolerance.contact_mm + EARLY_MM;
        moved(assembly, |_, _| reach_mm)
    }

    /// Extrudes the box of every element out of Omega in every direction and lists the elements whose boxes it meets
    /// deeper than the contact depth: the table of the paper.
    pub fn extruded(assembly: &Assembly) -> Interference {
        let table = mirrored(assembly, |number, direction, met| {
            met.extend(extruded(assembly, number, direction));
            Ok::<_, std::convert::Infallible>(())
        });
        match table {
            Ok(table) => table.guided(assembly),
            Err(never) => match never {},
        }
    }

    /// Returns the blockers of an element in a direction, in ascending order.
    pub fn blockers(&self, number: usize, direction: Direction) -> &[u32] {
        let row = 6 * number + direction.index();
        &self.entries[self.starts[row] as usize..self.starts[row + 1] as usize]
    }

    /// Returns the number of elements.
    pub fn len(&self) -> usize {
        (self.starts.len() - 1) / 6
    }

    /// Returns true when the table has no elements.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the number of entries in all rows.
    pub fn entries(&self) -> usize {
        self.entries.len()
    }

    /// Returns the heap that the table uses, bytes.
    pub fn heap_bytes(&self) -> usize {
        (self.entries.capacity() + self.starts.capacity()) * size_of::<u32>()
    }

    /// Returns the table without the pairs that `is_free` names, as for mates along their axis.
    #[must_use]
    pub fn without(self, is_free: impl Fn(usize, usize, Direction) -> bool) -> Interference {
        self.changed(|number, direction, row| {
            row.retain(|other| !is_free(number, *other as usize, direction));
        })
    }

    /// Returns a table in which `change` has edited each row.
    fn changed(&self, change: impl Fn(usize, Direction, &mut Vec<u32>)) -> Interference {
        let each = (0..self.len()).flat_map(|number| Direction::ALL.map(|it| (number, it)));
        Interference::joined(each.map(|(number, direction)| {
            let mut row = self.blockers(number, direction).to_vec();
            change(number, direction, &mut row);
            row
        }))
    }

    /// Enters the guided pairs: they block each other across their axis and never along it.
    fn guided(self, assembly: &Assembly) -> Interference {
        if assembly.guided().is_empty() {
            return self;
        }
        let mut pairs: Vec<(usize, usize, Option<usize>)> = Vec::new();
        for it in assembly.guided() {
            pairs.extend([(it.a, it.b, it.axis), (it.b, it.a, it.axis)]);
        }
        pairs.sort_unstable();
        self.changed(|number, direction, row| {
            let first = pairs.partition_point(|it| it.0 < number);
            for (_, other, axis) in pairs[first..].iter().take_while(|it| it.0 == number) {
                let is_across = axis.is_some_and(|axis| axis != direction.axis());
                let other = *other as u32;
                match (row.binary_search(&other), is_across) {
                    (Ok(at), false) => {
                        row.remove(at);
                    }
                    (Err(at), true) => row.insert(at, other),
                    (Ok(_), true) | (Err(_), false) => {}
                }
            }
        })
    }
}

/// Moves every element in every direction by a distance, mm, and lists what it meets.
fn moved(
    assembly: &Assembly,
    distance_mm: impl Fn(usize, Direction) -> f64,
) -> Result<Interference, PlanError> {
    let mut hits = Vec::new();
    let table = mirrored(assembly, |number, direction, met| {
        let way = direction.displacement(distance_mm(number, direction));
        assembly.add_met((number, [0.0; 3], way), &mut hits, met)
    });
    Ok(table?.guided(assembly))
}

/// Rows of all elements in one direction.
struct Rows {
    starts: Vec<u32>,
    entries: Vec<u32>,
}

impl Rows {
    fn of(&self, number: usize) -> &[u32] {
        &self.entries[self.starts[number] as usize..self.starts[number + 1] as usize]
    }

    /// Returns the rows in the opposite direction, in ascending order.
    fn mirrored(&self) -> Rows {
        let count = self.starts.len() - 1;
        let mut starts = vec![0_u32; count + 1];
        for other in &self.entries {
            starts[*other as usize + 1] += 1;
        }
        for number in 0..count {
            starts[number + 1] += starts[number];
        }
        let mut next = starts.clone();
        let mut entries = vec![0; self.entries.len()];
        for number in 0..count {
            for other in self.of(number) {
                let place = &mut next[*other as usize];
                entries[*place as usize] = number as u32;
                *place += 1;
            }
        }
        Rows { starts, entries }
    }
}

/// Fills the rows of the positive directions by `add`, and those of the negative directions by symmetry.
fn mirrored<E>(
    assembly: &Assembly,
    mut add: impl FnMut(usize, Direction, &mut Vec<u32>) -> Result<(), E>,
) -> Result<Interference, E> {
    let mut sides: Vec<Rows> = Vec::with_capacity(6);
    for direction in [Direction::PlusX, Direction::PlusY, Direction::PlusZ] {
        let mut rows = Rows {
            starts: vec![0],
            entries: Vec::new(),
        };
        for number in 0..assembly.len() {
            add(number, direction, &mut rows.entries)?;
            rows.starts.push(rows.entries.len() as u32);
        }
        let mirror = rows.mirrored();
        sides.extend([rows, mirror]);
    }
    let mut table = Interference {
        starts: Vec::with_capacity(6 * assembly.len() + 1),
        entries: Vec::with_capacity(sides.iter().map(|it| it.entries.len()).sum()),
    };
    table.starts.push(0);
    for number in 0..assembly.len() {
        for side in &sides {
            table.entries.extend_from_slice(side.of(number));
            table.starts.push(table.entries.len() as u32);
        }
    }
    Ok(table)
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
