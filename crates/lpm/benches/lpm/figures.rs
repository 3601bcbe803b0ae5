//! Prints the questions that have a bar (a limit that the benchmark must meet) as figures, one line of JSON each: how
//! many times as fast as parry3d-f64 the core is.

use super::timing::{Spread, TURNS, Timed};
use super::world::{KINDS, moves, world};
use super::{BAR, Bench, P99_BAR, QUERIES, stop};
use lpm::Move;
use serde_json::{Value, json};

/// Number of elements at which the bars apply.
const ELEMENTS: usize = 1_000;
/// Bars: least ratio of the time of an edit of the peer's raw tree to that of an edit of the core's model, for the mean
/// and for the 99th percentile.
const EDIT_BARS: [Option<f64>; 2] = [Some(4.0), Some(3.0)];
/// Bar: least ratio of the time of a rebuild of the peer's compound to that of an edit of the core's model.
const REBUILD_BAR: f64 = 1_000.0;

/// Prints a figure of this benchmark.
pub fn line(mut figure: Value) {
    figure["type"] = json!("figure");
    figure["study"] = json!("lpm");
    println!("{figure}");
}

/// Measures and prints all figures; `clock` is the cost of reading the clock, ns.
pub fn print(clock: f64) {
    let world = world(ELEMENTS);
    let bench = Bench::new(&world, clock);
    for kind in KINDS {
        question(&bench, kind, &moves(&world, kind, QUERIES));
    }
    let it = bench.measured_edits(&world);
    against(
        "building a model",
        1,
        &it.build,
        &it.rebuild,
        [Some(BAR), None],
    );
    let edit = "inserting and removing an element";
    against(edit, QUERIES, &it.edit, &it.double_edit, EDIT_BARS);
    let rebuilt = format!("{edit}, against a rebuild");
    against(
        &rebuilt,
        QUERIES,
        &it.edit,
        &it.rebuild,
        [Some(REBUILD_BAR), None],
    );
}

fn question(bench: &Bench, kind: &str, ways: &[Move]) {
    let timed = || Timed::new(ways, bench.clock);
    let (mut any, mut first, mut peer) = (timed(), timed(), timed());
    for _ in 0..TURNS {
        any.turn(|way| bench.model.any_hit(&bench.mover, way));
        first.turn(|way| stop(&bench.model, &bench.mover, way));
        peer.turn(|way| bench.double.compound(way));
    }
    let peer = peer.spread();
    for (question, ours) in [("any hit", any), ("first contact", first)] {
        let name = format!("{kind}, {question}");
        let bars = [Some(BAR), Some(P99_BAR)];
        against(&name, QUERIES, &ours.spread(), &peer, bars);
    }
}

/// Prints the ratios of peer to core for mean and 99th percentile, each with its bar.
fn against(name: &str, n: usize, ours: &Spread, peer: &Spread, bars: [Option<f64>; 2]) {
    let ratios = [("mean", ours.mean, peer.mean), ("p99", ours.p99, peer.p99)];
    for ((which, ours_ns, peer_ns), bar) in ratios.into_iter().zip(bars) {
        line(json!({
            "figure": format!("{name}: {which}"), "n": n, "value": peer_ns / ours_ns, "unit": "times as fast",
            "ours_ns": ours_ns, "peer_ns": peer_ns, "bar": bar.map(|bar| format!(">= {bar}")),
        }));
    }
}
