//! Speed of the collision core beside that of its peers, measured in one run: `cargo bench -p lpm`.
//!
//! Prints nanoseconds, and the ratios of peer to core for mean and 99th percentile: with warm caches, in random order,
//! and with cold caches. Prints how many answers differ and, below a missed bar (a ratio that the core must reach),
//! where the time goes ([`missed`]).
//!
//! | argument after `--` | effect |
//! |---|---|
//! | `--quick` | stops at 1,000 elements |
//! | `--bar` | measures at 1,000 elements only |
//! | `--growth` | measures how the cost of the core alone grows from 10 to 100,000 elements ([`growth`]) |
//! | `--json` | prints figures, one line of JSON each: the questions with a bar at 1,000 elements, or with `--growth` every cost |
//! | `counts` | counts instructions, branches and cache lines per question under valgrind ([`counts`]) |

mod answers;
mod counts;
mod figures;
mod growth;
mod missed;
mod peer;
mod timing;
mod world;

use lpm::{Answer, Model, Move, Mover, Pose, Shape};
use timing::{Rounds, Spread, TURNS, Timed, clock_ns, cold};
use world::{KINDS, World, gripper, moves, world};

/// Numbers of elements of the measured worlds.
const SIZES: [usize; 5] = [10, 100, 1_000, 10_000, 100_000];
/// Number of queries of each kind.
const QUERIES: usize = 2_000;
/// Number of queries of each kind with cold caches.
const COLD_QUERIES: usize = 300;
/// Margin of the moves in the rows named "margin", mm.
const MARGIN_MM: f64 = 0.5;
/// Bar: least ratio of the mean time of parry3d-f64 to that of the core.
const BAR: f64 = 12.0;
/// Bar: least ratio of the 99th percentile of the time of parry3d-f64 to that of the core.
const P99_BAR: f64 = 15.0;
/// Range of the clearance question, mm, as in `relayrig check`.
const RANGE_MM: f64 = 25.0;

fn main() {
    let asked = |name: &str| std::env::args().any(|argument| argument == name);
    let row: Vec<String> = std::env::args().skip_while(|it| it != "counted").collect();
    match (asked("counts"), row.get(1..)) {
        (true, _) => return counts::print(),
        (false, Some(row)) => return counts::ask(row),
        (false, None) => {}
    }
    let clock = clock_ns();
    match (asked("--growth"), asked("--json")) {
        (true, true) => return growth::print_figures(clock),
        (false, true) => return figures::print(clock),
        (_, false) => {}
    }
    println!(
        "one query alone, best of several passes, ns; cost of the clock taken off: {clock:.1} ns"
    );
    if asked("--growth") {
        return growth::print(clock);
    }
    let sizes: &[usize] = match (asked("--quick"), asked("--bar")) {
        (_, true) => &[1_000],
        (true, false) => &[10, 100, 1_000],
        (false, false) => &SIZES,
    };
    for size in sizes.iter().copied() {
        let world = world(size);
        println!(
            "\n## n = {size}: plate of {:.2} m, highest top {:.0} mm",
            world.edge_mm / 1e3,
            world.top_mm
        );
        Bench::new(&world, clock).report(&world);
    }
}

struct Bench {
    clock: f64,
    model: Model,
    mover: Mover,
    double: peer::double::Peer,
    single: peer::single::Peer,
}

/// Times of building, copying and editing a model, ns.
struct Edits {
    build: Spread,
    /// Building the compound of the peer in double precision.
    rebuild: Spread,
    /// Building the compound of the peer in single precision.
    single_rebuild: Spread,
    copy: Spread,
    /// Inserting and removing an element.
    edit: Spread,
    /// Inserting and removing a leaf of the peer's raw tree in double precision.
    double_edit: Spread,
    /// Inserting and removing a leaf of the peer's raw tree in single precision.
    single_edit: Spread,
}

fn built(world: &World) -> Model {
    let elements = world.elements.iter();
    let named = elements.map(|(shape, pose)| ("element", shape, pose));
    Model::of(named).expect("valid bodies")
}

fn mover(parts: Vec<(Shape, Pose)>) -> Mover {
    let parts = parts.into_iter().map(|(shape, pose)| (pose, shape));
    Mover::new(&Shape::Compound(parts.collect())).expect("valid blocks and cylinders")
}

/// Picks elements for edits.
fn picked(world: &World, edits: usize) -> Vec<usize> {
    let count = world.elements.len();
    let numbers = (0..edits).map(|index| 1 + index * 7919 % (count - 1));
    numbers.collect()
}

fn stop(model: &Model, mover: &Mover, way: &Move) -> Option<f64> {
    match model.first_contact(mover, way) {
        Answer::Clear => None,
        Answer::Blocked(contact) => Some(contact.t_stop),
    }
}

impl Bench {
    fn new(world: &World, clock: f64) -> Bench {
        let parts = gripper();
        Bench {
            clock,
            model: built(world),
            double: peer::double::Peer::new(&world.elements, &parts),
            single: peer::single::Peer::new(&world.elements, &parts),
            mover: mover(parts),
        }
    }

    fn report(&self, world: &World) {
        self.edits(world);
        println!(
            "\n{:<10} {:>5} {:<14} {:>22}   {:>19} {:>19} {:>19}",
            "warm",
            "hits",
            "question",
            "median/mean/p99",
            "f64 one call",
            "f64 over pairs",
            "f32 best"
        );
        println!(
            "{:<10} {:>5} {:<14} {:>22}   {:>19} {:>19} {:>19}",
            "", "", "", "ours, ns", "x mean, x p99", "x mean, x p99", "x mean, x p99"
        );
        for kind in KINDS {
            self.kind(kind, &moves(world, kind, QUERIES));
        }
        self.margins(world);
        self.far_above(world);
        for kind in KINDS {
            self.unlearned_kind(kind, &moves(world, kind, QUERIES));
        }
        println!(
            "\n{:<10} {:>5} {:<14} {:>22}   {:>19} {:>19}",
            "cold", "", "question", "ours, ns", "f64 one call", "f64 over pairs"
        );
        for kind in KINDS {
            self.cold_kind(kind, &moves(world, kind, COLD_QUERIES));
        }
        for kind in KINDS {
            answers::differences(self, kind, &moves(world, kind, QUERIES));
        }
    }

    fn kind(&self, kind: &str, ways: &[Move]) {
        let Bench {
            clock,
            model,
            mover,
            double,
            single,
        } = self;
        let hits = ways
            .iter()
            .filter(|way| model.any_hit(mover, way).is_some())
            .count();
        let share = format!("{:.0}%", 100.0 * hits as f64 / ways.len() as f64);
        let timed = || Timed::new(ways, *clock);
        let (mut any, mut first, mut least) = (timed(), timed(), timed());
        let (mut one, mut pairs_any, mut pairs_first) = (timed(), timed(), timed());
        let (mut single_one, mut single_any, mut single_first) = (timed(), timed(), timed());
        for _ in 0..TURNS {
            any.turn(|way| model.any_hit(mover, way));
            first.turn(|way| stop(model, mover, way));
            one.turn(|way| double.compound(way));
            pairs_any.turn(|way| double.pairs_any(way));
            pairs_first.turn(|way| double.pairs_first(way));
            single_one.turn(|way| single.compound(way));
            single_any.turn(|way| single.pairs_any(way));
            single_first.turn(|way| single.pairs_first(way));
            least.turn(|way| model.clearance(mover, way, RANGE_MM));
        }
        let (one, single_one) = (one.spread(), single_one.spread());
        let any = any.spread();
        row(
            kind,
            &share,
            "any hit",
            &any,
            &[
                one,
                pairs_any.spread(),
                best(single_one, single_any.spread()),
            ],
        );
        missed::of_question(self, ways, &one, &any, &|mover, way| {
            model.any_hit(mover, way).is_some()
        });
        let first = first.spread();
        row(
            kind,
            &share,
            "first contact",
            &first,
            &[
                one,
                pairs_first.spread(),
                best(single_one, single_first.spread()),
            ],
        );
        missed::of_question(self, ways, &one, &first, &|mover, way| {
            stop(model, mover, way).is_some()
        });
        row(kind, &share, "clearance", &least.spread(), &[]);
    }

    /// Measures the first contact with a margin of half a millimetre: both core and peer must then search iteratively.
    fn margins(&self, world: &World) {
        for kind in ["jog5", "descend", "local300"] {
            let mut ways = moves(world, kind, QUERIES);
            ways.iter_mut().for_each(|way| way.margin_mm = MARGIN_MM);
            let mut first = Timed::new(&ways, self.clock);
            let mut pairs = Timed::new(&ways, self.clock);
            for _ in 0..TURNS {
                first.turn(|way| stop(&self.model, &self.mover, way));
                pairs.turn(|way| self.double.pairs_first(way));
            }
            row(
                kind,
                "",
                "within 0.5 mm",
                &first.spread(),
                &[pairs.spread()],
            );
        }
    }

    /// Measures moves far above all elements: only the processing of poses takes time.
    fn far_above(&self, world: &World) {
        let ways = missed::lifted(&moves(world, "disc_yaw0", QUERIES));
        self.any_row("far above", "any hit", || Timed::new(&ways, self.clock));
    }

    /// Measures queries whose order changes from pass to pass, so that the branch predictor does not learn it.
    fn unlearned_kind(&self, kind: &str, ways: &[Move]) {
        self.any_row(kind, "any, no order", || Timed::unlearned(ways, self.clock));
    }

    fn any_row<'a>(&self, kind: &str, question: &str, timed: impl Fn() -> Timed<'a, Move<'a>>) {
        let (mut any, mut one, mut pairs) = (timed(), timed(), timed());
        for _ in 0..TURNS {
            any.turn(|way| self.model.any_hit(&self.mover, way));
            one.turn(|way| self.double.compound(way));
            pairs.turn(|way| self.double.pairs_any(way));
        }
        row(
            kind,
            "",
            question,
            &any.spread(),
            &[one.spread(), pairs.spread()],
        );
    }

    fn cold_kind(&self, kind: &str, ways: &[Move]) {
        let Bench {
            clock,
            model,
            mover,
            double,
            ..
        } = self;
        let one = cold(ways, *clock, |way| double.compound(way));
        let any = cold(ways, *clock, |way| model.any_hit(mover, way));
        let pairs = cold(ways, *clock, |way| double.pairs_any(way));
        row(kind, "", "any hit", &any, &[one, pairs]);
        let first = cold(ways, *clock, |way| stop(model, mover, way));
        let pairs = cold(ways, *clock, |way| double.pairs_first(way));
        row(kind, "", "first contact", &first, &[one, pairs]);
    }

    /// Measures building a model, copying it, and editing it.
    fn measured_edits(&self, world: &World) -> Edits {
        let count = world.elements.len();
        let times = if count > 5_000 { 9 } else { 201 };
        let bodies = peer::double::Peer::bodies(&world.elements);
        let single_bodies = peer::single::Peer::bodies(&world.elements);
        let [mut whole, mut rebuild, mut single_rebuild, mut copy] =
            [(); 4].map(|()| Rounds::new(times));
        for _ in 0..TURNS {
            whole.turn(|| (), |()| built(world));
            peer::double::Peer::build(&bodies, &mut rebuild);
            peer::single::Peer::build(&single_bodies, &mut single_rebuild);
            copy.turn(|| (), |()| self.model.clone());
        }
        let picked = picked(world, QUERIES);
        let mut model = self.model.clone();
        let (mut double, mut single) = (self.double.editor(), self.single.editor());
        let timed = || Timed::new(&picked, self.clock);
        let (mut edit, mut double_edit, mut single_edit) = (timed(), timed(), timed());
        for _ in 0..TURNS {
            edit.turn(|index| {
                let (shape, pose) = &world.elements[*index];
                let key = model.insert("element", shape, pose);
                model.remove(key.expect("a valid body"))
            });
            double_edit.turn(&mut double);
            single_edit.turn(&mut single);
        }
        Edits {
            build: whole.spread(),
            rebuild: rebuild.spread(),
            single_rebuild: single_rebuild.spread(),
            copy: copy.spread(),
            edit: edit.spread(),
            double_edit: double_edit.spread(),
            single_edit: single_edit.spread(),
        }
    }

    fn edits(&self, world: &World) {
        let it = self.measured_edits(world);
        let rebuild = it.rebuild;
        row(
            "build",
            "",
            "whole model",
            &it.build,
            &[rebuild, rebuild, it.single_rebuild],
        );
        missed::of_build(&it.copy, &it.build, &rebuild);
        row(
            "edit",
            "",
            "insert, remove",
            &it.edit,
            &[rebuild, it.double_edit, it.single_edit],
        );
        println!(
            "(edit: against a rebuild of the compound, and against insert and remove of a leaf of the raw tree)"
        );
        let bytes = self.model.heap_bytes() as f64 / world.elements.len() as f64;
        println!("memory: {bytes:.0} bytes per element");
    }
}

fn best(a: Spread, b: Spread) -> Spread {
    if a.mean < b.mean { a } else { b }
}

fn row(kind: &str, share: &str, question: &str, ours: &Spread, peers: &[Spread]) {
    let times = format!("{:.0}/{:.0}/{:.0}", ours.median, ours.mean, ours.p99);
    print!("{kind:<10} {share:>5} {question:<14} {times:>22}  ");
    for peer in peers {
        let ratio = format!("{:.1}, {:.1}", peer.mean / ours.mean, peer.p99 / ours.p99);
        print!(" {ratio:>19}");
    }
    println!();
}
