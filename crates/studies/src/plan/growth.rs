//! Measures time and memory for large scenes.

use crate::figure::{Bar, Figure};
use lpm::{ElementKey, Model, Move, Mover};
use plan::fixture::rows;
use plan::{
    Assembly, Demands, Direction, Interference, Leg, Planner, Problem, Remaining, Tolerance, Way,
};
use std::hint::black_box;
use std::time::Instant;

/// Runs of each measurement; the shortest counts.
const RUNS: usize = 5;

pub(super) fn figures() -> anyhow::Result<Vec<Figure>> {
    let mut figures = of_size(
        1_000,
        [Some(Bar::AtMost(1.5)), None, Some(Bar::AtMost(50.0))],
    )?;
    figures.extend(of_size(10_000, [None, Some(Bar::AtMost(10_000.0)), None])?);
    Ok(figures)
}

/// Returns the figures of a scene; the bars are those of ratio, table and sequence, in this order.
fn of_size(
    count: usize,
    [ratio, table, sequence]: [Option<Bar>; 3],
) -> anyhow::Result<Vec<Figure>> {
    let assembly = Assembly::new(rows(count), None, Tolerance::default(), Vec::new())?;
    let n = count as u64;
    let sweeps = Sweeps::of(&assembly)?;
    let sweeps_ms = shortest_ms(|| Ok(sweeps.first_contacts()))?;
    let table_ms = shortest_ms(|| Ok(black_box(Interference::swept(&assembly)?).len()))?;
    let found = Interference::swept(&assembly)?;
    let planner = Planner::new(&assembly, Vec::new())?;
    let order_ms = shortest_ms(|| {
        black_box(planner.disassembly(&Demands::default())?);
        Ok(0)
    })?;
    let barred = |figure: Figure, bar: Option<Bar>| match bar {
        Some(bar) => figure.bar(bar),
        None => figure,
    };
    let (touched, rows_of_element) = removal(&found);
    Ok(vec![
        barred(
            Figure::new(
                format!("{n} elements: table / its first-contact sweeps"),
                n,
                Some(table_ms / sweeps_ms),
                "",
            )
            .with("sweeps ms", Some(sweeps_ms)),
            ratio,
        ),
        barred(
            Figure::new(format!("{n} elements: table"), n, Some(table_ms), "ms")
                .with("entries", Some(found.entries() as f64))
                .with("MB", Some(found.heap_bytes() as f64 / 1e6)),
            table,
        ),
        barred(
            Figure::new(format!("{n} elements: sequence"), n, Some(order_ms), "ms"),
            sequence,
        ),
        Figure::none(
            format!("{n} elements: rows that a removal touches without need"),
            n,
            (touched - rows_of_element) as u64,
        )
        .with("touched", Some(touched as f64))
        .with("rows", Some(6.0 * count as f64)),
    ])
}

/// Returns the shortest of [`RUNS`] times, ms.
fn shortest_ms(work: impl Fn() -> anyhow::Result<usize>) -> anyhow::Result<f64> {
    let mut least_ms = f64::INFINITY;
    for _ in 0..RUNS {
        let start = Instant::now();
        black_box(work()?);
        least_ms = least_ms.min(start.elapsed().as_secs_f64() * 1e3);
    }
    Ok(least_ms)
}

/// Removes one element from the dynamic table. Returns the number of rows that the removal touches, and the number of
/// rows that name the element.
fn removal(table: &Interference) -> (usize, usize) {
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
    let gone = table.len() / 2;
    remaining.remove(gone, |_| {});
    let rows = (0..table.len()).flat_map(|it| Direction::ALL.map(|one| table.blockers(it, one)));
    let blocked = rows.filter(|row| row.contains(&(gone as u32))).count();
    (remaining.touched(), blocked)
}

/// Every element as a mover among all others, for plain sweeps.
struct Sweeps<'a> {
    assembly: &'a Assembly,
    model: Model,
    bodies: Vec<(ElementKey, Mover)>,
}

impl Sweeps<'_> {
    /// Shrinks every body by the contact depth, as tables do.
    fn of(assembly: &Assembly) -> anyhow::Result<Sweeps<'_>> {
        let depth_mm = 0.5 * assembly.tolerance().contact_mm;
        let elements = assembly.elements();
        let thin: Vec<_> = elements.iter().map(|it| it.shape.less(depth_mm)).collect();
        let named = elements.iter().zip(&thin);
        let model = Model::of(named.map(|(it, shape)| (it.id.as_str(), shape, &it.pose)));
        let model = model.map_err(|(_, flaw)| flaw)?;
        let movers = thin.iter().map(Mover::new);
        let movers = movers.collect::<Result<Vec<_>, _>>()?;
        Ok(Sweeps {
            assembly,
            bodies: model.keys().zip(movers).collect(),
            model,
        })
    }

    /// Sweeps every element out of the checking space in six directions, each up to its first contact; returns the
    /// number of sweeps that met something.
    fn first_contacts(&self) -> usize {
        for (number, (key, mover)) in self.bodies.iter().enumerate() {
            let from = self.assembly.elements()[number].pose;
            for direction in Direction::ALL {
                let extent = self.assembly.extent(number);
                let distance_mm = self.assembly.distance_out_mm(extent, direction);
                let by = direction.displacement(distance_mm);
                let to = [0, 1, 2].map(|axis| from.position[axis] + by[axis]);
                let way = Move {
                    from,
                    to: from.moved_to(to),
                    margin_mm: 0.0,
                    ignore: &[*key],
                };
                black_box(self.model.first_contact(mover, &way));
            }
        }
        self.bodies.len()
    }
}
