//! Counts instructions, branches and cache lines per question under valgrind, for the core and for parry3d-f64. These
//! counts depend little on the machine, and not at all on its load.
//!
//! `-- counts` starts this program again under callgrind, once per row and contestant; callgrind counts inside
//! [`counted`]. The simulated caches have the sizes of [`CACHES`] on every machine. The simulated branch predictor is
//! simpler than that of today's processors: its count resembles that of a processor that has not learned the questions.
//! With cold caches `lines fetched` counts the cache lines of data that come from memory, including those of stack,
//! constants and question.

use std::fs;
use std::hint::black_box;
use std::path::PathBuf;
use std::process::Command;

use super::world::{Dice, KINDS, World, moves, world};
use super::{Bench, built, peer, stop};
use lpm::Move;

/// First level of instructions, first level of data, and last level: bytes, ways, bytes per line.
const CACHES: [&str; 3] = ["--I1=32768,8,64", "--D1=49152,12,64", "--LL=2097152,16,64"];
/// Bytes written before each cold question: more than the simulated caches hold.
const FLUSHED_BYTES: usize = 8 << 20;
/// Number of elements.
const ELEMENTS: usize = 1_000;
/// Number of questions of each kind with warm caches.
const QUESTIONS: usize = 1_000;
/// Number of questions of each kind with cold caches.
const COLD_QUESTIONS: usize = 40;
/// States of the caches and of the branch predictor in which questions are asked.
const STATES: [&str; 3] = ["warm", "no order", "cold"];
/// What is counted, by the names of callgrind.
const COLUMNS: [(&str, &[&str]); 5] = [
    ("instructions", &["Ir"]),
    ("branches", &["Bc", "Bi"]),
    ("mispredicted", &["Bcm", "Bim"]),
    ("D1 misses", &["D1mr", "D1mw"]),
    ("lines fetched", &["DLmr", "DLmw"]),
];

/// Prints the table: a row for each kind of question and state, one for building and one for editing.
pub fn print() {
    println!(
        "counts per question among {ELEMENTS} elements, any hit / first contact / parry3d-f64 in one call; caches {}",
        CACHES.join(" ")
    );
    print!("{:<20}", "");
    COLUMNS.iter().for_each(|(name, _)| print!(" {name:>20}"));
    println!();
    for kind in KINDS {
        for state in STATES {
            row(kind, state, &["any", "first", "peer"]);
        }
    }
    row("build", "an element", &["ours", "peer"]);
    row("edit", "in and out", &["ours", "peer"]);
}

fn row(kind: &str, state: &str, contestants: &[&str]) {
    print!("{:<20}", format!("{kind}, {state}"));
    let counts: Vec<_> = contestants
        .iter()
        .map(|who| counts(kind, state, who))
        .collect();
    for (_, events) in COLUMNS {
        let sum = |counts: &Vec<(String, f64)>| {
            let counted = counts.iter().filter(|(name, _)| events.contains(&&**name));
            format!("{:.1}", counted.map(|(_, count)| count).sum::<f64>())
        };
        let sums: Vec<String> = counts.iter().map(sum).collect();
        print!(" {:>20}", sums.join("/"));
    }
    println!();
}

/// Starts this program under callgrind and returns the names of the events with their counts, per question.
fn counts(kind: &str, state: &str, contestant: &str) -> Vec<(String, f64)> {
    let file = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("counts");
    let own = std::env::current_exe().expect("this program has a path");
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--cache-sim=yes", "--branch-sim=yes"])
        .args(["--collect-atstart=no", "--toggle-collect=*counts*counted*"])
        .args(CACHES)
        .arg(format!("--callgrind-out-file={}", file.display()))
        .arg(own)
        .args(["counted", kind, state, contestant])
        .output()
        .expect("valgrind is installed");
    let times: f64 = String::from_utf8_lossy(&output.stdout)
        .trim()
        .parse()
        .expect("the number of questions");
    let text = fs::read_to_string(file).expect("callgrind wrote this file");
    let fields = |key: &str| {
        let line = text.lines().find_map(|line| line.strip_prefix(key));
        line.unwrap_or_default().split_whitespace()
    };
    let totals = fields("totals:").map(|count| count.parse::<f64>().expect("a count") / times);
    fields("events:").map(str::to_owned).zip(totals).collect()
}

/// Asks the questions of one row and contestant, and prints their number.
pub fn ask(row: &[String]) {
    let [kind, state, contestant] = row else {
        panic!("expected a kind, a state and a contestant, found {row:?}");
    };
    let world = world(ELEMENTS);
    match &**kind {
        "build" => build(&world, contestant),
        "edit" => edit(&world, contestant),
        kind => {
            let few = if state == "cold" {
                COLD_QUESTIONS
            } else {
                QUESTIONS
            };
            questions(&world, &moves(&world, kind, few), state, contestant);
        }
    }
}

fn build(world: &World, contestant: &str) {
    println!("{}", world.elements.len());
    if contestant == "peer" {
        let bodies = peer::double::Peer::bodies(&world.elements);
        let mut bodies = Some(bodies);
        counted(&mut || bodies.take().map(peer::double::Peer::built));
    } else {
        counted(&mut || built(world));
    }
}

fn edit(world: &World, contestant: &str) {
    let bench = Bench::new(world, 0.0);
    let picked = super::picked(world, QUESTIONS);
    if contestant == "peer" {
        return all(&picked, &picked, false, bench.double.editor());
    }
    let mut model = bench.model.clone();
    all(&picked, &picked, false, |index: &usize| {
        let (shape, pose) = &world.elements[*index];
        let key = model.insert("element", shape, pose);
        model.remove(key.expect("a valid body"))
    });
}

fn questions(world: &World, ways: &[Move], state: &str, contestant: &str) {
    let Bench {
        model,
        mover,
        double,
        ..
    } = &Bench::new(world, 0.0);
    let mut mixed = ways.to_vec();
    Dice::new(7).shuffle(&mut mixed);
    // The predictor has learned the questions when they come in the same order twice.
    let (first, is_cold) = (if state == "warm" { ways } else { &mixed }, state == "cold");
    match contestant {
        "any" => all(first, ways, is_cold, |way| model.any_hit(mover, way)),
        "first" => all(first, ways, is_cold, |way| stop(model, mover, way)),
        _ => all(first, ways, is_cold, |way| double.compound(way)),
    }
}

/// Asks the questions `first` to warm the caches, then counts what the questions `then` cost.
fn all<Q, A>(first: &[Q], then: &[Q], is_cold: bool, mut ask: impl FnMut(&Q) -> A) {
    println!("{}", then.len());
    let mut ballast = vec![0u8; if is_cold { FLUSHED_BYTES } else { 0 }];
    for question in first {
        black_box(ask(black_box(question)));
    }
    for question in then {
        ballast.iter_mut().step_by(64).for_each(|line| *line ^= 1);
        black_box(&mut ballast);
        counted(&mut || ask(black_box(question)));
    }
}

/// Runs what is counted; callgrind knows this function by its name.
#[inline(never)]
fn counted<A>(ask: &mut dyn FnMut() -> A) {
    black_box(ask());
}
