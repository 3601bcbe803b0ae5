//! Runs the tests of `tests/browser` in a real browser over the built program; `prepare` installs what is missing.
//!
//! Pictures of every page are in `target/tmp/browser/screenshots`. To run one test file over any build:
//! `tests/browser/run PROGRAM config FOLDER tests/browser/operator.test.mjs`. Those of the page of all rigs need an empty
//! PostgreSQL database.
//!
//! A test binary of its own, so that no browser runs beside the tests over pseudo-terminals, which are in real time.

#![cfg(all(feature = "sim", feature = "fleet", unix))]
#![allow(clippy::unwrap_used)]

use std::path::Path;
use std::process::Command;

#[test]
fn the_page_does_in_a_browser_what_it_promises() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let database = fleet::trial::Trial::start().unwrap();
    let done = Command::new(root.join("tests/browser/run"))
        .arg(env!("CARGO_BIN_EXE_relayrig"))
        .arg(root.join("config"))
        .arg(Path::new(env!("CARGO_TARGET_TMPDIR")).join("browser"))
        .env("DATABASE", format!("127.0.0.1:{}", database.port))
        .output()
        .unwrap();
    let said = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let (stdout, stderr) = (said(&done.stdout), said(&done.stderr));
    assert!(done.status.success(), "{stdout}\n{stderr}");
    let tried = stdout.contains(" pass ") && !stdout.contains(" pass 0\n");
    assert!(tried, "no test was run: {stdout}");
}
