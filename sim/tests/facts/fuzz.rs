//! Garbage on a line: nothing falls over, and what is not understood changes nothing.

#[path = "../fuzz/garbage.rs"]
mod garbage;

/// Of these about one in four is answered. The full run: `cargo bench -p rigsim --bench device_fuzz`.
const INPUTS: u64 = 40_000;

#[test]
fn garbage_makes_no_module_fall_over_and_changes_nothing() {
    let seen = garbage::throw(1, INPUTS);
    assert!(
        seen.answered > INPUTS / 100 && seen.unheard > INPUTS / 2,
        "{seen:?}"
    );
}
