//! 10^7 random inputs for the device codec: `cargo bench -p rigsim --bench device_fuzz [-- INPUTS [SEED] [--json]]`.
//!
//! Ends at a panic, or when an unanswered input changes a register. `--json` prints the counts as figures, a line of
//! JSON each.

#[path = "../tests/fuzz/garbage.rs"]
mod garbage;

use serde_json::json;

fn main() {
    let numbers: Vec<u64> = std::env::args()
        .filter_map(|word| word.parse().ok())
        .collect();
    let inputs = numbers.first().copied().unwrap_or(10_000_000);
    let seed = numbers.get(1).copied().unwrap_or(1);
    let began = std::time::Instant::now();
    let seen = garbage::throw(seed, inputs);
    if std::env::args().any(|word| word == "--json") {
        let line = |figure: &str, count: u64| {
            let line = json!({
                "type": "figure", "study": "device_fuzz", "figure": figure, "n": inputs, "value": count, "unit": "",
            });
            println!("{line}");
        };
        line("random inputs with an answer", seen.answered);
        line(
            "random inputs met with silence that changed nothing",
            seen.unheard,
        );
        return;
    }
    println!(
        "device_fuzz: seed {seed}, {inputs} inputs, {} answered, {} met with silence that changed nothing, 0 panics, {:.1} s",
        seen.answered,
        seen.unheard,
        began.elapsed().as_secs_f64(),
    );
}
