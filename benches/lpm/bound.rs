//! What a missed bar is made of: parts of the same questions, measured in the same run.

use relayrig::lpm::{Move, Mover};

use super::timing::{Spread, rounds, warm};
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

/// Below a missed bar: taking the poses (everything stands far below), which nobody who is asked this way can
/// leave out; and with it finding whose boxes meet (four specks in the corners of the gripper's box, which meet
/// next to nothing, so that no hit ends the question): the rest of the time is that of shapes.
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

/// A copy of the model, and a plain block of as many bytes: whoever builds writes what is kept at least once, into
/// memory that was asked for. Where the system takes memory back between two models, most of it is that.
pub fn of_build(bench: &Bench, times: usize, ours: &Spread, peer: &Spread) {
    let copy = rounds(times, || (), |()| bench.model.clone());
    row("build", "", "copy of it", &copy, &[*peer]);
    let bytes = bench.model.heap_bytes();
    let block = rounds(times, || (), |()| vec![1u8; bytes]);
    row("build", "", "block of bytes", &block, &[*peer]);
    if peer.mean < BAR * ours.mean {
        println!(
            "  (bar of {BAR}: {:.0} ns; a copy {:.2} of the bar, a block of as many bytes {:.2} of it)",
            peer.mean / BAR,
            BAR * copy.mean / peer.mean,
            BAR * block.mean / peer.mean,
        );
    }
}
