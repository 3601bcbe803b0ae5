//! Measures how the cost of the core grows with the number of elements at constant density.

use super::timing::{Rounds, TURNS, Timed};
use super::world::{KINDS, gripper, moves, world};
use super::{QUERIES, RANGE_MM, SIZES, built, mover, stop};

/// Prints each cost (time or memory) at every size, and the ratio of the largest to the smallest. Measurements
/// alternate between the sizes.
pub fn report(clock: f64) {
    let mover = mover(gripper());
    let worlds = SIZES.map(world);
    let models = worlds.each_ref().map(built);
    let mut table: Vec<(String, Vec<f64>)> = Vec::new();
    let mut whole = SIZES.map(|size| Rounds::new(if size > 5_000 { 5 } else { 51 }));
    for _ in 0..TURNS {
        for (whole, world) in whole.iter_mut().zip(&worlds) {
            whole.turn(|| (), |()| built(world));
        }
    }
    let whole = whole.into_iter().zip(SIZES);
    let spent = whole.map(|(whole, size)| whole.spread().median / size as f64);
    table.push(("build, ns an element".to_owned(), spent.collect()));
    let bytes = models.iter().zip(SIZES);
    let bytes = bytes.map(|(model, size)| model.heap_bytes() as f64 / size as f64);
    table.push(("memory, bytes an element".to_owned(), bytes.collect()));
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
            table.push((format!("{kind}, {question}"), means.collect()));
        }
    }
    print!("{:<26}", "mean, ns; n =");
    SIZES.iter().for_each(|size| print!(" {size:>9}"));
    println!("   largest / smallest (bar for local moves, any hit and first contact: below 2)");
    for (name, figures) in table {
        print!("{name:<26}");
        figures.iter().for_each(|figure| print!(" {figure:>9.0}"));
        println!("   {:.2}", figures[SIZES.len() - 1] / figures[0]);
    }
}
