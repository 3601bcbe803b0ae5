//! Measures how the cost of the core grows with the number of elements at constant density.

use super::figures::line;
use super::timing::{Rounds, TURNS, Timed};
use super::world::{KINDS, gripper, moves, world};
use super::{QUERIES, RANGE_MM, SIZES, built, mover, stop};
use serde_json::json;

/// Bar: the cost of a local move at the largest size, divided by that at the smallest, must stay below this.
const BAR: f64 = 2.0;
/// Kinds of local moves.
const LOCAL: [&str; 2] = ["jog5", "local300"];

/// A cost, in time or memory, at every size.
struct Cost {
    name: String,
    /// Number of queries that the mean includes.
    n: usize,
    /// Whether the bar applies.
    has_bar: bool,
    unit: &'static str,
    at: Vec<f64>,
}

impl Cost {
    /// Returns the cost at the largest size divided by that at the smallest.
    fn ratio(&self) -> f64 {
        self.at[SIZES.len() - 1] / self.at[0]
    }
}

/// Measures each cost; measurements alternate between the sizes.
fn costs(clock: f64) -> Vec<Cost> {
    let mover = mover(gripper());
    let worlds = SIZES.map(world);
    let models = worlds.each_ref().map(built);
    let mut table = Vec::new();
    let mut add = |name: String, n, has_bar, unit, at: Vec<f64>| {
        table.push(Cost {
            name,
            n,
            has_bar,
            unit,
            at,
        });
    };
    let mut whole = SIZES.map(|size| Rounds::new(if size > 5_000 { 5 } else { 51 }));
    for _ in 0..TURNS {
        for (whole, world) in whole.iter_mut().zip(&worlds) {
            whole.turn(|| (), |()| built(world));
        }
    }
    let whole = whole.into_iter().zip(SIZES);
    let spent = whole.map(|(whole, size)| whole.spread().median / size as f64);
    add(
        "build, an element".to_owned(),
        1,
        false,
        "ns",
        spent.collect(),
    );
    let bytes = models.iter().zip(SIZES);
    let bytes = bytes.map(|(model, size)| model.heap_bytes() as f64 / size as f64);
    add(
        "memory, an element".to_owned(),
        1,
        false,
        "bytes",
        bytes.collect(),
    );
    for kind in KINDS {
        let ways = worlds.each_ref().map(|world| moves(world, kind, QUERIES));
        let timed = || ways.each_ref().map(|ways| Timed::new(ways, clock));
        let (mut any, mut first, mut least) = (timed(), timed(), timed());
        for _ in 0..TURNS {
            for (at, model) in models.iter().enumerate() {
                any[at].turn(|way| model.any_hit(&mover, way));
                first[at].turn(|way| stop(model, &mover, way));
                least[at].turn(|way| model.clearance(&mover, way, RANGE_MM));
            }
        }
        for (question, timed) in [
            ("any hit", any),
            ("first contact", first),
            ("clearance", least),
        ] {
            let means = timed.into_iter().map(|timed| timed.spread().mean);
            let has_bar = LOCAL.contains(&kind) && question != "clearance";
            add(
                format!("{kind}, {question}"),
                QUERIES,
                has_bar,
                "ns",
                means.collect(),
            );
        }
    }
    table
}

/// Prints each cost at every size, and the cost at the largest size divided by that at the smallest.
pub fn print(clock: f64) {
    print!("{:<26}", "mean; n =");
    SIZES.iter().for_each(|size| print!(" {size:>9}"));
    println!("   largest / smallest (bar for local moves, any hit and first contact: below {BAR})");
    for cost in costs(clock) {
        print!("{:<26}", format!("{}, {}", cost.name, cost.unit));
        cost.at.iter().for_each(|figure| print!(" {figure:>9.0}"));
        println!("   {:.2}", cost.ratio());
    }
}

/// Prints for each cost a figure: the cost at the largest size divided by that at the smallest, with the cost at every
/// size.
pub fn print_figures(clock: f64) {
    for cost in costs(clock) {
        let mut figure = json!({
            "figure": cost.name, "n": cost.n, "value": cost.ratio(), "unit": "times",
            "bar": cost.has_bar.then(|| format!("< {BAR}")),
        });
        for (size, cost_at) in SIZES.iter().zip(&cost.at) {
            figure[format!("{}_at_{size}", cost.unit)] = json!(cost_at);
        }
        line(figure);
    }
}
