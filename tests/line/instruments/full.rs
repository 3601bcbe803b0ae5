//! The full storm on links to instruments: `cargo bench --bench link_storm [-- QUERIES [SEED] [--json]]`.
//!
//! First all faults together, each at 1 %, in storms of ten minutes of rig time with a calm after each; then each fault
//! alone at 3 %, with a fifth of the queries over all of them. Counts the values that reach another query, the programs
//! that hang, the failures without a name and the links that do not recover; ends with status 1 when any count is above
//! 0. `--json` prints the sums as figures, a line of JSON each.

mod storm;

use serde_json::json;
use std::collections::BTreeMap;
use std::process::ExitCode;
use storm::{WAYS, Way, Weather, each_fault, every_fault, storm};

/// Number of queries over all ways.
const QUERIES: u64 = 100_000;
/// Probabilities of each fault: with all others, and alone.
const TOGETHER: f64 = 0.01;
const ALONE: f64 = 0.03;
/// Rig time of a storm.
const STORM_S: f64 = 600.0;

fn main() -> ExitCode {
    let words = || std::env::args().skip(1);
    let numbers: Vec<u64> = words().filter_map(|word| word.parse().ok()).collect();
    let queries = numbers.first().copied().unwrap_or(QUERIES);
    let seed = numbers.get(1).copied().unwrap_or(1);
    let all: Vec<(String, Vec<Weather>)> = together(seed, queries)
        .into_iter()
        .chain(alone(seed, queries / 5))
        .collect();
    match words().any(|word| word == "--json") {
        true => print_figures(all.iter().flat_map(|(_, storms)| storms)),
        false => all.iter().for_each(|(name, storms)| print(name, storms)),
    }
    let mut every = all.iter().flat_map(|(_, storms)| storms);
    ExitCode::from(u8::from(!every.all(Weather::is_honest)))
}

/// Returns the storms of all faults together on each way.
fn together(seed: u64, queries: u64) -> Vec<(String, Vec<Weather>)> {
    let faults = every_fault(TOGETHER, STORM_S);
    let share = queries / WAYS.len() as u64;
    let of = |way| {
        (
            format!("all faults, {way:?}"),
            storms(way, seed, &faults, share),
        )
    };
    WAYS.map(of).into()
}

/// Returns the storms of each fault alone.
fn alone(seed: u64, queries: u64) -> Vec<(String, Vec<Weather>)> {
    let each = each_fault(ALONE, STORM_S);
    let share = queries / each.len() as u64;
    let of = |(way, faults): (Way, Vec<String>)| {
        let name = format!("{} alone, {way:?}", faults[0]);
        (name, storms(way, seed, &faults, share))
    };
    each.into_iter().map(of).collect()
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

/// Returns storms under `faults` with at least `queries` queries together.
fn storms(way: Way, seed: u64, faults: &[String], queries: u64) -> Vec<Weather> {
    let mut storms = Vec::new();
    let mut sent = 0;
    for seed in seed.. {
        if sent >= queries {
            break;
        }
        let weather = virtual_time::block_on(storm(way, seed, faults, STORM_S));
        let weather = weather.expect("a runtime");
        sent += weather.queries;
        storms.push(weather);
    }
    storms
}

fn print(name: &str, storms: &[Weather]) {
    let sum = |of: fn(&Weather) -> u64| storms.iter().map(of).sum::<u64>();
    let seconds = |of: fn(&Weather) -> f64| storms.iter().map(of).sum::<f64>();
    println!(
        "{name}: {} queries, {} delivered, {} foreign (bar 0), {} hangs (bar 0), {} nameless (bar 0), \
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
