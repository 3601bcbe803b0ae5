//! Drives the simulated instruments with pyvisa-py and the drivers of pymeasure, and servers of other makers with
//! `relayrig instrument`; the script `run` installs drivers and servers from PyPI.
//!
//! A test binary of its own, so that nothing else loads the computer beside instruments in real time.

#![cfg(all(feature = "sim", unix))]
#![allow(clippy::unwrap_used)]

mod serve;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Lock of the running test: the first test installs the packages, and no other test loads the computer meanwhile.
static TURN: Mutex<()> = Mutex::new(());

fn turn() -> MutexGuard<'static, ()> {
    TURN.lock().unwrap_or_else(PoisonError::into_inner)
}

fn file(name: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    root.join("tests/instruments").join(name)
}

/// Returns the command of a Python with the packages that `requirements.txt` names.
fn python() -> Command {
    let mut python = Command::new(file("run"));
    python.arg(Path::new(env!("CARGO_TARGET_TMPDIR")).join("instruments"));
    python
}

#[test]
fn other_programs_drive_the_simulated_instruments() {
    let _turn = turn();
    let done = python()
        .arg(file("drive.py"))
        .args([env!("CARGO_BIN_EXE_relayrig"), "sim", "--instruments"])
        .arg(file("bench.toml"))
        .output()
        .unwrap();
    let said = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let (stdout, stderr) = (said(&done.stdout), said(&done.stderr));
    assert!(done.status.success(), "{stdout}\n{stderr}");
    assert!(stdout.contains("passed "), "no check was made: {stdout}");
}
