//! Density of assertions in the modules around the machine.

use super::tree::{Source, assert_none, rust_files};

/// Modules with their least number of assertions per 1000 lines of code outside tests.
const LEAST: [(&str, usize); 5] = [
    ("station", 8),
    ("handling", 8),
    ("cycle", 8),
    ("bus", 8),
    ("history", 8),
];

/// Beginnings of lines with an assertion.
const ASSERTIONS: [&str; 6] = [
    "assert!(",
    "assert_eq!(",
    "assert_ne!(",
    "debug_assert!(",
    "debug_assert_eq!(",
    "debug_assert_ne!(",
];

/// Counts lines of code before the tests of a file, and assertions among them.
fn counted(source: &Source) -> (usize, usize) {
    let outside = source
        .code()
        .map(|(_, code)| code.trim())
        .take_while(|code| *code != "#[cfg(test)]");
    outside.fold((0, 0), |(lines, asserted), code| {
        let asserts = ASSERTIONS.iter().any(|it| code.starts_with(it));
        (lines + 1, asserted + usize::from(asserts))
    })
}

#[test]
fn modules_around_the_machine_have_assertions() {
    let sources = rust_files(&["src", "crates"]);
    let mut broken = Vec::new();
    for (module, least) in LEAST {
        let of_module = |it: &&Source| it.room() == Some(module) && !it.is_test();
        let (lines, asserted) = sources
            .iter()
            .filter(of_module)
            .map(counted)
            .fold((0, 0), |all, one| (all.0 + one.0, all.1 + one.1));
        assert!(lines > 0, "no line of `{module}`");
        if 1000 * asserted < least * lines {
            broken.push(format!(
                "{module}: {asserted} assertions in {lines} lines, expected {least} per 1000"
            ));
        }
    }
    assert_none(&broken);
}
