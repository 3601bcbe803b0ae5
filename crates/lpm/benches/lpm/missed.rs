//! Shows where the time behind a missed bar goes: measures parts of the same questions in the same run.

use lpm::{Move, Mover};

use super::timing::{Spread, warm};
use super::world::specks;
use super::{BAR, Bench, P99_BAR, mover, row};

/// Height above every element, mm.
const FAR_ABOVE_MM: f64 = 10_000.0;

/// Returns `ways` lifted far above the elements.
pub fn lifted<'a>(ways: &[Move<'a>]) -> Vec<Move<'a>> {
    let mut above = ways.to_vec();
    for way in &mut above {
        way.from.position[2] += FAR_ABOVE_MM;
        way.to.position[2] += FAR_ABOVE_MM;
    }
    above
}

/// Prints, below a missed bar, the cost of processing poses alone (all elements lie far below), and the cost of poses
/// plus the search for overlapping boxes. For the second cost the mover is four specks in the corners of the gripper's
/// box: they meet almost nothing, so no hit ends the question early. These costs show where the time goes, not that the
/// bar is out of reach.
pub fn of_question(
    bench: &Bench,
    ways: &[Move],
    peer: &Spread,
    ours: &Spread,
    ask: &dyn Fn(&Mover, &Move) -> bool,
) {
    if peer.mean >= BAR * ours.mean && peer.p99 >= P99_BAR * ours.p99 {
        return;
    }
    let poses = warm(&lifted(ways), bench.clock, |way| ask(&bench.mover, way));
    let specks = mover(specks());
    let boxes = warm(ways, bench.clock, |way| ask(&specks, way));
    println!(
        "  (bars of {BAR} and {P99_BAR}: mean {:.0}, p99 {:.0} ns; poses alone {:.0}, {:.0}: {:.2} of the bar; poses and boxes {:.0}, {:.0}: {:.2} of it)",
        peer.mean / BAR,
        peer.p99 / P99_BAR,
        poses.mean,
        poses.p99,
        BAR * poses.mean / peer.mean,
        boxes.mean,
        boxes.p99,
        BAR * boxes.mean / peer.mean,
    );
}

/// Prints how long copying the model takes. A copy writes the same data once into memory of the same structure, so that
/// no building can be faster. Where the system reclaims memory between two models, copying and building both pay for
/// it.
pub fn of_build(copy: &Spread, ours: &Spread, peer: &Spread) {
    row("build", "", "copy of it", copy, &[*peer]);
    if peer.mean < BAR * ours.mean {
        println!(
            "  (bar of {BAR}: {:.0} ns; a copy {:.2} of the bar)",
            peer.mean / BAR,
            BAR * copy.mean / peer.mean,
        );
    }
}
