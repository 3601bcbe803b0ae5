//! The full storm of line faults: `cargo bench -p bus --bench line_storm [-- TRANSACTIONS [SEED] [FAULT=VALUE]...
//! [--json]]`.
//!
//! Counts the wrong readings that the line accepts; ends with status 1 when there is one. Also prints the number of
//! wrong readings to expect: two modules that reply simultaneously produce, with a small probability, a frame with a
//! correct checksum. Without a named fault, every fault has a probability of 1 %. `--json` prints the counts as
//! figures, one line of JSON each.

#[path = "../../../tests/line/storm/rage.rs"]
mod rage;

use dcon::{Address, AnalogIn, Channel, DataFormat, InputForm, TypeCode};
use rage::{EVERY_FAULT, Weather, rage};
use rigsim::fault::LineFaults;
use serde_json::json;
use std::process::ExitCode;

/// Number of transactions, none of which may give a wrong reading.
const TRANSACTIONS: u64 = 1_000_000;
/// Number of clashes (pairs of simultaneous replies) that the program draws to estimate how often two replies pass for
/// one.
const CLASHES: u32 = 4_000_000;
/// Share of the transactions, 0 to 1, that read a list: all inputs at once.
const LISTS: f64 = 1.0 / 20.0;
const FORM: InputForm = InputForm::eight(DataFormat::Hex, TypeCode(0x08));
/// Faults whose damage a host can detect.
const DETECTABLE: [&str; 5] = ["truncate", "flip", "noise", "garble", "clash"];

fn main() -> ExitCode {
    let words = || std::env::args().skip(1);
    let numbers: Vec<u64> = words().filter_map(|word| word.parse().ok()).collect();
    let named: Vec<String> = words().filter(|word| word.contains('=')).collect();
    let mut faults: Vec<&str> = named.iter().map(String::as_str).collect();
    if faults.is_empty() {
        faults.extend(EVERY_FAULT);
    }
    let transactions = numbers.first().copied().unwrap_or(TRANSACTIONS);
    let seed = numbers.get(1).copied().unwrap_or(1);
    let weather = rage(seed, transactions, &faults);
    if words().any(|word| word == "--json") {
        print_figures(&weather);
        return ExitCode::from(u8::from(!weather.is_honest()));
    }
    println!("line_storm: seed {seed}, {}", faults.join(" "));
    print_counts(&weather);
    print_expected(weather.transactions as f64, &faults);
    weather.examples.iter().for_each(|lie| println!("{lie}"));
    ExitCode::from(u8::from(!weather.is_honest()))
}

/// Counts of broken rules of a storm; each must be 0.
fn broken(weather: &Weather) -> [(&'static str, u64); 5] {
    [
        ("readings of another channel", weather.foreign),
        ("readings older than their request", weather.stale),
        ("accepted writes not carried out", weather.hollow),
        ("failures without a name", weather.nameless),
        ("hangs", weather.hangs),
    ]
}

fn print_figures(weather: &Weather) {
    let line = |figure: &str, count: u64, bar: Option<&str>| {
        let line = json!({
            "type": "figure", "study": "line_storm", "figure": figure, "n": weather.transactions, "value": count,
            "unit": "", "bar": bar,
        });
        println!("{line}");
    };
    for (figure, count) in broken(weather) {
        line(figure, count, Some("<= 0"));
    }
    line("replies believed", weather.believed, None);
    line(
        "transactions that failed",
        weather.failures.values().sum(),
        None,
    );
}

fn print_counts(weather: &Weather) {
    let row = |name: &str, count: u64, bar: &str| println!("{name:<38} {count:>9}  {bar}");
    row("transactions", weather.transactions, "");
    row("believed", weather.believed, "");
    for (kind, count) in &weather.failures {
        row(&format!("failed: {kind}"), *count, "");
    }
    for (name, count) in broken(weather) {
        row(name, count, "bar 0");
    }
    println!(
        "{:.0} s of rig time in {:.1} s, {:.0} transactions/s of wall time",
        weather.rig_s,
        weather.wall_s,
        weather.transactions as f64 / weather.wall_s,
    );
}

/// Prints how many wrong readings, which no host can detect, to expect among n transactions. It uses four shares
/// between 0 and 1. c: transactions with two simultaneous replies. p: such pairs that pass for another value. q: such
/// pairs, at a read of all inputs, that lie within the noise of the reads before and after. d: replies whose damage a
/// host detects.
fn print_expected(n: f64, faults: &[&str]) {
    let channel = Channel::new(0).expect("0 is a channel");
    let (p, _) = passing(
        AnalogIn::ReadOne {
            channel,
            form: FORM,
        },
        4,
    );
    let (_, q) = passing(AnalogIn::ReadAll(FORM), 32);
    let c = chance(faults, "clash");
    let calm: f64 = DETECTABLE
        .iter()
        .map(|name| 1.0 - chance(faults, name))
        .product();
    let in_sight = calm.powi(i32::from(bus::PROBATION_ANSWERS));
    println!("two modules at one address, two characters apart at most:");
    println!(
        "  p, share that passes for another value {p:.2e} (in step 1/41, 8 bits 1/256: 9.5e-5)"
    );
    let rest = [
        (
            "believed before any damage was seen  n c p (1 - d)^100",
            n * c * p * in_sight,
        ),
        (
            "two of three answers damaged         3 n (c p)^2",
            3.0 * n * (c * p).powi(2),
        ),
        (
            "all inputs at once, within the noise n / 20 c q",
            n * LISTS * c * q,
        ),
    ];
    println!(
        "  believed if no read were repeated   n c p                {:.3}",
        n * c * p
    );
    for (what, times) in rest {
        println!("  {what:<57} {times:.4}");
    }
    let times: f64 = rest.iter().map(|(_, times)| times).sum();
    println!("  to be expected in all {times:.4}");
}

/// Returns the probability of the fault `name`; 0 when the list lacks this fault.
fn chance(faults: &[&str], name: &str) -> f64 {
    let values = faults.iter().filter_map(|fault| fault.split_once('='));
    let mut own = values.filter(|(known, _)| *known == name);
    let value = own.next().and_then(|(_, value)| value.parse().ok());
    value.unwrap_or(0.0)
}

/// Draws replies of `digits` digits that overlap with a second reply. Returns the share that passes for another value,
/// and the share that also lies so near to the reads before and after that the line accepts it.
fn passing(read: AnalogIn, digits: usize) -> (f64, f64) {
    let command = read.to(Address(1));
    let mut faults = LineFaults::none(1);
    faults.add("clash", Some("1")).expect("a known fault");
    let (mut other, mut close) = (0u32, 0u32);
    for draw in 0..CLASHES {
        let word = format!("{:04X}", draw.wrapping_mul(0x9E37_79B9) >> 16);
        let text = format!(">{}", word.repeat(digits / 4));
        let mut frame = format!("{text}{:02X}\r", dcon::checksum(text.as_bytes())).into_bytes();
        let Ok(truth) = command.decode(&frame, true) else {
            continue;
        };
        faults.clash("01", &mut frame, 0);
        if let Ok(heard) = command.decode(&frame, true)
            && heard != truth
        {
            other += 1;
            close += u32::from(command.select_answer(&[truth, heard, truth], 0) == Some(1));
        }
    }
    let share = |count: u32| f64::from(count) / f64::from(CLASHES);
    (share(other), share(close))
}
