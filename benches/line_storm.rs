//! The storm of line faults in full: `cargo bench --bench line_storm [-- TRANSACTIONS [SEED]]`.
//!
//! Prints what the judge found, and ends with status 1 when anything false was believed.

#[path = "../tests/line/storm/rage.rs"]
mod rage;

use rage::{EVERY_FAULT, rage};
use std::process::ExitCode;

/// The bar: that many transactions without a lie.
const TRANSACTIONS: u64 = 1_000_000;

fn main() -> ExitCode {
    let numbers: Vec<u64> = std::env::args()
        .filter_map(|word| word.parse().ok())
        .collect();
    let transactions = numbers.first().copied().unwrap_or(TRANSACTIONS);
    let seed = numbers.get(1).copied().unwrap_or(1);
    let weather = rage(seed, transactions, &EVERY_FAULT);
    println!("line_storm: seed {seed}, {}", EVERY_FAULT.join(" "));
    let row = |name: &str, count: u64, bar: &str| println!("{name:<34} {count:>9}  {bar}");
    row("transactions", weather.transactions, "");
    row("believed", weather.believed, "");
    for (kind, count) in &weather.failures {
        row(&format!("failed: {kind}"), *count, "");
    }
    row("readings of another channel", weather.foreign, "bar 0");
    row("readings older than their request", weather.stale, "bar 0");
    row("accepted writes not carried out", weather.hollow, "bar 0");
    row("failures without a name", weather.nameless, "bar 0");
    row("hangs", weather.hangs, "bar 0");
    println!(
        "{:.0} s of rig time in {:.1} s, {:.0} transactions/s of wall time",
        weather.rig_s,
        weather.wall_s,
        weather.transactions as f64 / weather.wall_s,
    );
    weather.examples.iter().for_each(|lie| println!("{lie}"));
    ExitCode::from(u8::from(!weather.is_honest()))
}
