//! The full storm on links to instruments: `cargo bench --bench link_storm [-- QUERIES [SEED] [--json]]`.
//!
//! Every fault has a probability of 1 %, in storms of ten minutes of rig time with a calm after each. Counts the values
//! that reach another query, the programs that hang, the failures without a name and the links that do not recover; ends
//! with status 1 when there is one. `--json` prints the sums over all ways as figures, a line of JSON each.

mod storm;

use serde_json::json;
use std::collections::BTreeMap;
use std::process::ExitCode;
use storm::{WAYS, Way, Weather, every_fault, storm};

/// Queries over all ways.
const QUERIES: u64 = 100_000;
/// Rig time of a storm.
const STORM_S: f64 = 600.0;

fn main() -> ExitCode {
    let words = || std::env::args().skip(1);
    let numbers: Vec<u64> = words().filter_map(|word| word.parse().ok()).collect();
    let queries = numbers.first().copied().unwrap_or(QUERIES);
    let seed = numbers.get(1).copied().unwrap_or(1);
    let all = WAYS.map(|way| (way, storms(way, seed, queries / WAYS.len() as u64)));
    match words().any(|word| word == "--json") {
        true => print_figures(all.iter().flat_map(|(_, storms)| storms)),
        false => all.iter().for_each(|(way, storms)| print(*way, storms)),
    }
    let mut every = all.iter().flat_map(|(_, storms)| storms);
    ExitCode::from(u8::from(!every.all(Weather::is_honest)))
}

fn print_figures<'a>(storms: impl Iterator<Item = &'a Weather> + Clone) {
    let sum = |of: fn(&Weather) -> u64| storms.clone().map(of).sum::<u64>();
    for (figure, count, bar) in [
        (
            "values of another query",
            sum(|it| it.foreign),
            Some("<= 0"),
        ),
        ("programs that hang", sum(|it| it.hangs), Some("<= 0")),
        (
            "failures without a name",
            sum(|it| it.nameless),
            Some("<= 0"),
        ),
        (
            "links that do not recover",
            sum(|it| it.unrecovered),
            Some("<= 0"),
        ),
        ("values delivered", sum(|it| it.delivered), None),
    ] {
        let n = sum(|it| it.queries);
        println!(
            "{}",
            json!({"type": "figure", "study": "link_storm", "figure": figure, "n": n, "value": count, "unit": "", "bar": bar})
        );
    }
}

/// Returns storms with at least `queries` queries together.
fn storms(way: Way, seed: u64, queries: u64) -> Vec<Weather> {
    let mut storms = Vec::new();
    let mut sent = 0;
    for seed in seed.. {
        if sent >= queries {
            break;
        }
        let weather = in_virtual_time(storm(way, seed, &every_fault(0.01, STORM_S), STORM_S));
        sent += weather.queries;
        storms.push(weather);
    }
    storms
}

fn in_virtual_time<F: Future>(what: F) -> F::Output {
    tokio::runtime::Builder::new_current_thread()
        .enable_time()
        .start_paused(true)
        .build()
        .expect("a runtime")
        .block_on(what)
}

fn print(way: Way, storms: &[Weather]) {
    let sum = |of: fn(&Weather) -> u64| storms.iter().map(of).sum::<u64>();
    let seconds = |of: fn(&Weather) -> f64| storms.iter().map(of).sum::<f64>();
    println!(
        "all faults, {way:?}: {} queries, {} delivered, {} foreign (bar 0), {} hangs (bar 0), {} nameless (bar 0), \
         {} unrecovered (bar 0), {:.0} s of rig time in {:.1} s",
        sum(|it| it.queries),
        sum(|it| it.delivered),
        sum(|it| it.foreign),
        sum(|it| it.hangs),
        sum(|it| it.nameless),
        sum(|it| it.unrecovered),
        seconds(|it| it.rig_s),
        seconds(|it| it.wall_s),
    );
    let mut failures = BTreeMap::new();
    for name in storms.iter().flat_map(|it| &it.failures) {
        *failures.entry(*name).or_insert(0) += 1;
    }
    println!("  failed programs: {failures:?}");
    let examples = storms.iter().flat_map(|it| &it.examples);
    examples.for_each(|it| println!("  {it}"));
}
