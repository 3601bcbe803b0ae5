//! Forbidden names in pure modules, places of `unsafe`, forbidden habits of tests, typed failures.

use super::tree::{assert_none, has_word, rust_files};

/// Names of clocks, sockets, files, `async` and logging.
const PURE: &[&str] = &[
    "units",
    "chamber",
    "form",
    "dcon",
    "lpm",
    "guard",
    "gauge",
    "rig",
    "instrument",
    "dut",
    "handling",
    "station",
    "quality",
    "texts",
    "view",
    "report",
];

/// Names that only outer modules may use.
const OUTSIDE: &[&str] = &[
    "std::fs",
    "std::net",
    "std::io",
    "std::env",
    "std::process",
    "std::thread",
    "tokio",
    "async",
    "await",
    "tracing",
    "SystemTime",
    "Instant::now",
    "println",
    "eprintln",
    "print",
    "dbg",
];

/// Modules whose matches have no `_` arm, so that the compiler finds every place for a new state.
const TOTAL: &[&str] = &[
    "chamber",
    "handling",
    "station",
    "guard",
    "cycle",
    "gauge",
    "instrument",
    "dut",
];

#[test]
fn the_listed_modules_exist() {
    let sources = rust_files(&["src", "crates"]);
    let exists = |module: &&&str| sources.iter().any(|source| source.room() == Some(**module));
    let missing = PURE.iter().chain(TOTAL).filter(|module| !exists(module));
    let broken: Vec<String> = missing
        .map(|module| format!("no module `{module}`"))
        .collect();
    assert_none(&broken);
}

#[test]
fn pure_modules_use_neither_clock_nor_io_nor_async() {
    let mut broken = Vec::new();
    for source in rust_files(&["src", "crates"]) {
        let Some(module) = source.room().filter(|name| PURE.contains(name)) else {
            continue;
        };
        for (line, code) in source.code() {
            for word in OUTSIDE.iter().filter(|word| has_word(code, word)) {
                broken.push(format!(
                    "{}:{line}: `{module}` is pure and must not name `{word}`",
                    source.path
                ));
            }
        }
    }
    assert_none(&broken);
}

/// The keyword as it appears in code, not in texts.
const UNSAFE: [&str; 6] = ["{", "fn", "impl", "trait", "extern", "("];

#[test]
fn unsafe_code_is_in_the_collision_core_only() {
    let keyword = concat!("un", "safe");
    let is_code = |code: &str| {
        UNSAFE.iter().any(|next| {
            code.contains(&format!("{keyword} {next}"))
                || code.contains(&format!("{keyword}{next}"))
        })
    };
    let mut broken = Vec::new();
    for source in rust_files(&["src", "crates", "sim", "tests"]) {
        for (line, _) in source.code().filter(|(_, code)| is_code(code)) {
            if source.room() != Some("lpm") {
                broken.push(format!(
                    "{}:{line}: `{keyword}` outside crates/lpm",
                    source.path
                ));
            }
        }
    }
    assert_none(&broken);
}

#[test]
fn the_core_matches_every_state_by_name() {
    let mut broken = Vec::new();
    for source in rust_files(&["src", "crates"]) {
        if source.is_test() || !source.room().is_some_and(|name| TOTAL.contains(&name)) {
            continue;
        }
        for (line, code) in source
            .code()
            .filter(|(_, code)| code.trim_start().starts_with("_ =>"))
        {
            broken.push(format!(
                "{}:{line}: `{}` hides the states to come",
                source.path,
                code.trim()
            ));
        }
    }
    assert_none(&broken);
}

#[test]
fn a_failure_is_a_type_and_never_a_text() {
    let mut broken = Vec::new();
    for source in rust_files(&["src", "crates"]) {
        let result = |code: &str| code.contains("Result<") && code.contains(", String>");
        let of_map = |code: &str| code.contains("Map<") || code.contains("get::<");
        for (line, code) in source.code().filter(|_| !source.is_test()) {
            if result(code) && !of_map(code) {
                broken.push(format!("{}:{line}: a failure without a type", source.path));
            }
        }
    }
    assert_none(&broken);
}

#[test]
fn no_test_sleeps_and_none_is_ignored() {
    let ignored = concat!("#[", "ignore");
    let sleeps = [concat!("thread::", "sleep"), concat!("time::", "sleep(")];
    let mut broken = Vec::new();
    for source in rust_files(&["src", "crates", "sim", "tests"]) {
        for (line, code) in source.code() {
            if code.contains(ignored) {
                broken.push(format!("{}:{line}: an ignored test", source.path));
            }
            if source.is_test() && sleeps.iter().any(|sleep| code.contains(sleep)) {
                broken.push(format!("{}:{line}: a test that sleeps", source.path));
            }
        }
    }
    assert_none(&broken);
}

#[test]
fn only_the_guard_makes_a_clearance() {
    let mut broken = Vec::new();
    for source in rust_files(&["src", "crates"]) {
        if source.room() == Some("guard") {
            continue;
        }
        for (line, code) in source.code() {
            if code.contains("Cleared::new")
                || code.contains("Cleared {") && !code.contains("struct")
            {
                broken.push(format!(
                    "{}:{line}: a `Cleared` that no guard has made",
                    source.path
                ));
            }
        }
    }
    assert_none(&broken);
}
