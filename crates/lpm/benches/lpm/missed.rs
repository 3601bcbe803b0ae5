//! What a missed bar is made of: parts of the same questions, measured in the same run.

use lpm::{Move, Mover};

use super::timing::{Spread, warm};
use super::world::specks;
use super::{BAR, Bench, mover, row};

/// Higher than anything stands, mm.
const FAR_ABOVE_MM: f64 = 10_000.0;

/// The same moves where nothing stands.
pub fn lifted<'a>(ways: &[Move<'a>]) -> Vec<Move<'a>> {
    let mut above = ways.to_vec();
    for way in &mut above {
        way.from.position[2] += FAR_ABOVE_MM;
        way.to.position[2] += FAR_ABOVE_MM;
    }
    above
}

/// Below a missed bar: what taking the poses costs here (everything stands far below), and with it finding whose
/// boxes meet (four specks in the corners of the gripper's box, which meet next to nothing, so that no hit ends
/// the question). That is where the time goes; it does not show that the bar is out of reach.
pub fn of_question(
    bench: &Bench,
    ways: &[Move],
    peer: &Spread,
    ours: &Spread,
    ask: &dyn Fn(&Mover, &Move) -> bool,
) {
    if peer.mean >= BAR * ours.mean && peer.p99 >= BAR * ours.p99 {
        return;
    }
    let poses = warm(&lifted(ways), bench.clock, |way| ask(&bench.mover, way));
    let specks = mover(specks());
    let boxes = warm(ways, bench.clock, |way| ask(&specks, way));
    println!(
        "  (bar of {BAR}: mean {:.0}, p99 {:.0} ns; poses alone {:.0}, {:.0}: {:.2} of the bar; poses and boxes {:.0}, {:.0}: {:.2} of it)",
        peer.mean / BAR,
        peer.p99 / BAR,
        poses.mean,
        poses.p99,
        BAR * poses.mean / peer.mean,
        boxes.mean,
        boxes.p99,
        BAR * boxes.mean / peer.mean,
    );
}

/// A copy of the model: all that is kept written once, into memory of the same pieces. Where the system takes
/// memory back between two models, both pay for it. Building cannot be faster.
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
