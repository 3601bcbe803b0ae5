//! Drives the simulated instruments with pyvisa-py and the drivers of pymeasure; `run` installs them from PyPI.
//!
//! A test binary of its own, so that nothing else loads the computer beside instruments in real time.

#![cfg(all(feature = "sim", unix))]
#![allow(clippy::unwrap_used)]

use std::path::Path;
use std::process::Command;

#[test]
fn other_programs_drive_the_simulated_instruments() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let done = Command::new(root.join("tests/instruments/run"))
        .arg(env!("CARGO_BIN_EXE_relayrig"))
        .arg(Path::new(env!("CARGO_TARGET_TMPDIR")).join("instruments"))
        .output()
        .unwrap();
    let said = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let (stdout, stderr) = (said(&done.stdout), said(&done.stderr));
    assert!(done.status.success(), "{stdout}\n{stderr}");
    assert!(stdout.contains("passed "), "no check was made: {stdout}");
}
