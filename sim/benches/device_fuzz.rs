//! 10^7 random inputs for the device codec: `cargo bench -p rigsim --bench device_fuzz [-- INPUTS [SEED]]`.

#[path = "../tests/fuzz/garbage.rs"]
mod garbage;

fn main() {
    let numbers: Vec<u64> = std::env::args()
        .filter_map(|word| word.parse().ok())
        .collect();
    let inputs = numbers.first().copied().unwrap_or(10_000_000);
    let seed = numbers.get(1).copied().unwrap_or(1);
    let began = std::time::Instant::now();
    let seen = garbage::throw(seed, inputs);
    println!(
        "device_fuzz: seed {seed}, {inputs} inputs, {} answered, {} met with silence that changed nothing, 0 panics, {:.1} s",
        seen.answered,
        seen.unheard,
        began.elapsed().as_secs_f64(),
    );
}
