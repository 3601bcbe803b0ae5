//! The full storm on links to instruments: `cargo bench --bench link_storm [-- QUERIES [SEED] [--json]]`.
//!
//! Counts the values that reach another query, the programs that hang and the failures without a name; ends with status 1
//! when there is one. Every fault has a probability of 1 % together, then 3 % alone. `--json` prints the sums over all storms as figures, a
//! line of JSON each.

mod storm;

use serde_json::json;
use std::process::ExitCode;
use storm::{WAYS, Weather, alone, every_fault, storm};

/// Queries of all faults together, over all ways.
const QUERIES: u64 = 100_000;

fn main() -> ExitCode {
    let words = || std::env::args().skip(1);
    let numbers: Vec<u64> = words().filter_map(|word| word.parse().ok()).collect();
    let queries = numbers.first().copied().unwrap_or(QUERIES);
    let seed = numbers.get(1).copied().unwrap_or(1);
    let mut storms = Vec::new();
    for way in WAYS {
        let each = queries / WAYS.len() as u64;
        let weather = in_virtual_time(storm(way, seed, each, &every_fault(0.01)));
        storms.push((format!("all faults, {way:?}"), weather));
    }
    for (way, faults) in alone(0.03) {
        let weather = in_virtual_time(storm(way, seed, queries / 100, &faults));
        storms.push((faults.join(" "), weather));
    }
    match words().any(|word| word == "--json") {
        true => print_figures(&storms),
        false => storms
            .iter()
            .for_each(|(name, weather)| print(name, weather)),
    }
    let honest = storms.iter().all(|(_, weather)| weather.is_honest());
    ExitCode::from(u8::from(!honest))
}

fn print_figures(storms: &[(String, Weather)]) {
    let sum = |of: fn(&Weather) -> u64| storms.iter().map(|(_, it)| of(it)).sum::<u64>();
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
        ("values delivered", sum(|it| it.delivered), None),
    ] {
        let line = json!({
            "type": "figure", "study": "link_storm", "figure": figure, "n": sum(|it| it.queries), "value": count, "unit": "",
            "bar": bar,
        });
        println!("{line}");
    }
}

fn in_virtual_time<F: Future>(what: F) -> F::Output {
    tokio::runtime::Builder::new_current_thread()
        .enable_time()
        .start_paused(true)
        .build()
        .expect("a runtime")
        .block_on(what)
}

fn print(name: &str, weather: &Weather) {
    println!(
        "{name}: {} queries, {} delivered, {} foreign (bar 0), {} hangs (bar 0), {} nameless (bar 0), {:.0} s of rig time in {:.1} s",
        weather.queries,
        weather.delivered,
        weather.foreign,
        weather.hangs,
        weather.nameless,
        weather.rig_s,
        weather.wall_s,
    );
    println!("  failed programs: {:?}", weather.failures);
    weather.examples.iter().for_each(|it| println!("  {it}"));
}
