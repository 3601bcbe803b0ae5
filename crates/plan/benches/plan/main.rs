//! Times of tables and orders, each beside its bar: `cargo bench -p plan`.
//!
//! Elements stand on a plate in rows: blocks and cylinders of several heights, some stacked on others, as on a fixture.

use lpm::{Model, Move, Mover, Pose, Shape};
use plan::{Assembly, Demands, Direction, Element, Interference, Leg, Outcome, PlanError};
use plan::{Planner, Problem, Remaining, Tolerance, Way};
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use std::time::Instant;

/// Distance between the rows, mm.
const PITCH_MM: f64 = 30.0;

/// Runs of each measurement; the shortest counts.
const RUNS: usize = 5;

fn main() -> Result<(), PlanError> {
    let thousand = Assembly::new(scene(1_000), None, Tolerance::default(), Vec::new())?;
    let ((), sweeps_ms) = first_contacts(&thousand)?;
    let (table, table_ms) = timed(|| Interference::swept(&thousand))?;
    println!(
        "1,000 elements: 6,000 first-contact sweeps {sweeps_ms:.2} ms, full table {table_ms:.2} ms with {} entries, \
         ratio {:.2} (bar 1.5)",
        table.entries(),
        table_ms / sweeps_ms
    );
    let planner = Planner::new(&thousand, Vec::new())?;
    let (outcome, order_ms) = timed(|| planner.disassembly(&Demands::default()))?;
    if let Outcome::Sequence(sequence) = &outcome {
        let cost = sequence.cost();
        println!(
            "1,000 elements: sequence {order_ms:.2} ms (bar 50), {} steps, {} changes of direction, fewest proven: {}",
            sequence.steps.len(),
            cost.changes,
            sequence.is_fewest_changes
        );
    }
    update(&table);
    let many = Assembly::new(scene(10_000), None, Tolerance::default(), Vec::new())?;
    let (table, table_ms) = timed(|| Interference::swept(&many))?;
    println!(
        "10,000 elements: full table {:.2} s (bar 10), {} entries, {:.1} MB",
        table_ms / 1e3,
        table.entries(),
        table.heap_bytes() as f64 / 1e6
    );
    Ok(())
}

/// Returns what `made` makes, and the shortest of [`RUNS`] times, ms.
fn timed<T>(made: impl Fn() -> Result<T, PlanError>) -> Result<(T, f64), PlanError> {
    let mut least_ms = f64::INFINITY;
    for _ in 1..RUNS {
        let start = Instant::now();
        std::hint::black_box(made()?);
        least_ms = least_ms.min(start.elapsed().as_secs_f64() * 1e3);
    }
    let start = Instant::now();
    let value = made()?;
    Ok((value, least_ms.min(start.elapsed().as_secs_f64() * 1e3)))
}

fn scene(count: usize) -> Vec<Element> {
    let mut dice = Xoshiro256PlusPlus::seed_from_u64(1);
    let mut size = |least: f64, most: f64| {
        let part = (dice.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        least + part * (most - least)
    };
    let side = (count as f64 / 1.25).sqrt().ceil() as usize;
    let mut elements: Vec<Element> = Vec::new();
    for place in 0..side * side {
        let [x, y] = [place % side, place / side].map(|at| PITCH_MM * at as f64);
        let height = size(5.0, 60.0);
        let low = if place % 2 == 0 {
            Shape::Block {
                half: [size(3.0, 12.0), size(3.0, 12.0), 0.5 * height],
            }
        } else {
            Shape::Cylinder {
                radius: size(3.0, 12.0),
                height,
            }
        };
        elements.push(Element {
            id: format!("e{}", elements.len()),
            shape: low,
            pose: Pose::at([x, y, 0.5 * height]),
        });
        if place % 4 == 0 {
            let half = [size(3.0, 14.0), size(3.0, 14.0), 5.0];
            elements.push(Element {
                id: format!("e{}", elements.len()),
                shape: Shape::Block { half },
                pose: Pose::at([x, y, height + 5.0]),
            });
        }
    }
    elements.truncate(count);
    elements
}

/// Sweeps every element in every direction to its first contact, with everything else in the model, and times it.
fn first_contacts(assembly: &Assembly) -> Result<((), f64), PlanError> {
    let flawed = |id: &str, flaw| PlanError::Flawed {
        id: id.to_owned(),
        flaw,
    };
    let mut model = Model::new();
    let mut bodies = Vec::new();
    for it in assembly.elements() {
        let thin = it.shape.less(5e-5);
        let key = model.insert(&it.id, &thin, &it.pose);
        let key = key.map_err(|flaw| flawed(&it.id, flaw))?;
        let mover = Mover::new(&thin).map_err(|flaw| flawed(&it.id, flaw))?;
        bodies.push((key, mover));
    }
    timed(|| {
        for (number, (key, mover)) in bodies.iter().enumerate() {
            let from = assembly.elements()[number].pose;
            for direction in Direction::ALL {
                let distance_mm = assembly.distance_out_mm(assembly.extent(number), direction);
                let by = direction.displacement(distance_mm);
                let to = from.moved_to([0, 1, 2].map(|axis| from.position[axis] + by[axis]));
                let way = Move {
                    from,
                    to,
                    margin_mm: 0.0,
                    ignore: &[*key],
                };
                std::hint::black_box(model.first_contact(mover, &way));
            }
        }
        Ok(())
    })
}

/// Removes one element from the dynamic table and prints what that touches.
fn update(table: &Interference) {
    let way = |number: usize, direction: Direction| Way {
        legs: vec![Leg {
            direction,
            distance_mm: 1.0,
        }],
        blockers: table.blockers(number, direction).to_vec(),
    };
    let ways = (0..table.len()).map(|it| Direction::ALL.map(|one| way(it, one)).to_vec());
    let problem = Problem::new(ways.collect(), vec![true; table.len()]);
    let mut remaining = Remaining::all(&problem);
    let start = Instant::now();
    remaining.remove(table.len() / 2, |_| {});
    println!(
        "{} elements: one removal touches {} of {} rows in {:.1} us",
        table.len(),
        remaining.touched(),
        6 * table.len(),
        start.elapsed().as_secs_f64() * 1e6
    );
}
