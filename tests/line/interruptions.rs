//! Stopped and killed lots: every part on stdout has its rows once, and the history is intact.

use crate::program::Workshop;
use serde_json::Value;
use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Command};

/// Command of a lot without end.
const ENDLESS: &str = "run --sim --pace virtual --lot A --recipe jzc-22f-012 --seed 1 --json";

/// Result of an interrupted lot.
struct Ended {
    /// Exit status; `None` after a kill.
    status: Option<i32>,
    /// JSON lines on stdout.
    told: Vec<Value>,
}

/// Runs the endless lot and sends `signal` once `after` parts are on stdout.
fn interrupted(workshop: &Workshop, signal: &str, after: usize) -> Ended {
    let mut lot = workshop.start(ENDLESS);
    let mut out = BufReader::new(lot.stdout.take().unwrap());
    let mut text = String::new();
    for _ in 0..after {
        assert!(
            out.read_line(&mut text).unwrap() > 0,
            "the lot ended by itself"
        );
    }
    send(signal, &lot);
    out.read_to_string(&mut text).unwrap();
    let whole = text.rsplit_once('\n').map_or("", |(whole, _)| whole);
    Ended {
        status: lot.wait().unwrap().code(),
        told: crate::program::objects(whole),
    }
}

/// Sends a signal, by name, to a program.
pub fn send(signal: &str, lot: &Child) {
    let sent = Command::new("kill")
        .args(["-s", signal, &lot.id().to_string()])
        .status();
    assert!(sent.unwrap().success());
}

#[test]
fn ctrl_c_finishes_parts_inside_and_keeps_rows() {
    let workshop = Workshop::new("ctrl-c");
    let ended = interrupted(&workshop, "INT", 3);
    assert_eq!(ended.status, Some(4));
    let summary = ended.told.last().unwrap();
    assert_eq!(summary["type"], "summary", "{summary}");
    let parts = i64::try_from(ended.told.len() - 1).unwrap();
    assert_eq!(
        workshop.count("SELECT count(*) FROM part WHERE kind = 'lot'"),
        parts
    );
    assert_eq!(
        workshop.count("SELECT count(*) FROM part WHERE landed_bin IS NOT bin"),
        0
    );
    assert_eq!(
        workshop.count("SELECT count(*) FROM run WHERE closed_at_us IS NULL"),
        0
    );
}

#[test]
fn sigterm_ends_a_lot_as_ctrl_c_does() {
    let workshop = Workshop::new("sigterm");
    let ended = interrupted(&workshop, "TERM", 3);
    assert_eq!(ended.status, Some(4));
    assert_eq!(ended.told.last().unwrap()["type"], "summary");
}

#[test]
fn reported_parts_have_their_rows_once_after_a_kill() {
    let workshop = Workshop::new("killed");
    let ended = interrupted(&workshop, "KILL", 3);
    assert_eq!(ended.status, None);
    assert!(ended.told.len() >= 3);
    for part in &ended.told {
        let seq = &part["seq"];
        let rows = format!("SELECT count(*) FROM part WHERE kind = 'lot' AND seq = {seq}");
        assert_eq!(workshop.count(&rows), 1, "part {seq}");
    }
    workshop.run("history check").with_status(0);
    let again = ENDLESS.replace("--json", "--json --count 1");
    workshop.run(&again).with_status(0);
    assert_eq!(workshop.count("SELECT max(number) FROM run"), 2);
    assert_eq!(
        workshop.count("SELECT count(*) FROM run WHERE number = 1 AND closed_at_us IS NULL"),
        1
    );
}
