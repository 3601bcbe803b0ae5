//! Tests with random bytes on a line: no module panics, and unanswered input changes nothing.

#[path = "../fuzz/garbage.rs"]
mod garbage;

/// Number of inputs, a quarter of which get an answer. For the full run: `cargo bench -p rigsim --bench
/// device_fuzz`.
const INPUTS: u64 = 40_000;

#[test]
fn random_bytes_cause_no_panic_and_no_change() {
    let seen = garbage::throw(1, INPUTS);
    assert!(
        seen.answered > INPUTS / 100 && seen.unheard > INPUTS / 2,
        "{seen:?}"
    );
}
