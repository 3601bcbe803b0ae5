//! How the cost of the core grows with the number of elements at the same density.

use super::timing::{Rounds, TURNS, warm};
use super::world::{KINDS, gripper, moves, world};
use super::{QUERIES, RANGE_MM, SIZES, built, mover, stop};

/// Prints means, ns, for every size, and how many times the smallest world's the largest one's are.
pub fn report(clock: f64) {
    let mover = mover(gripper());
    let mut table: Vec<(String, Vec<f64>)> = Vec::new();
    let mut note = |name: String, figure: f64| match table.iter_mut().find(|row| row.0 == name) {
        Some((_, figures)) => figures.push(figure),
        None => table.push((name, vec![figure])),
    };
    for size in SIZES {
        let world = world(size);
        let model = built(&world);
        let times = if size > 5_000 { 5 } else { 51 };
        let mut whole = Rounds::new(times);
        (0..TURNS).for_each(|_| whole.turn(|| (), |()| built(&world)));
        let whole = whole.spread().median;
        note("build, ns an element".to_owned(), whole / size as f64);
        let bytes = model.heap_bytes() as f64 / size as f64;
        note("memory, bytes an element".to_owned(), bytes);
        for kind in KINDS {
            let ways = moves(&world, kind, QUERIES);
            let any = warm(&ways, clock, |way| model.any_hit(&mover, way));
            note(format!("{kind}, any hit"), any.mean);
            let first = warm(&ways, clock, |way| stop(&model, &mover, way));
            note(format!("{kind}, first contact"), first.mean);
            let least = warm(&ways, clock, |way| model.clearance(&mover, way, RANGE_MM));
            note(format!("{kind}, clearance"), least.mean);
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
