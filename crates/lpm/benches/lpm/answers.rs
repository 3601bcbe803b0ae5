//! Compares the answers of the core with those of its peer, the library parry3d.

use lpm::Move;

use super::{Bench, RANGE_MM, stop};

/// Prints how many verdicts of the core differ from those of the peer, and the largest differences in the time of
/// contact.
pub fn differences(bench: &Bench, kind: &str, ways: &[Move]) {
    let (mut verdicts, mut later, mut earlier) = (Vec::new(), 0.0_f64, 0.0_f64);
    for (index, way) in ways.iter().enumerate() {
        let length = distance(way.from.position, way.to.position);
        match (
            stop(&bench.model, &bench.mover, way),
            bench.double.pairs_first(way),
        ) {
            (Some(ours), Some(theirs)) => {
                later = later.max((ours - theirs) * length);
                earlier = earlier.max((theirs - ours) * length);
            }
            (None, None) => {}
            (ours, theirs) => verdicts.push((index, ours, theirs)),
        }
    }
    println!(
        "answers of {kind}: {} verdicts of {} differ from parry f64; contacts at most {later:.1e} mm later, {earlier:.1e} mm earlier",
        verdicts.len(),
        ways.len()
    );
    for (index, ours, theirs) in verdicts {
        let least = bench
            .model
            .clearance(&bench.mover, &ways[index], RANGE_MM)
            .map(|least| least.distance_mm);
        println!("  #{index}: ours {ours:?} with least distance {least:?} mm, theirs {theirs:?}");
    }
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b) * (a - b))
        .sum::<f64>()
        .sqrt()
}
