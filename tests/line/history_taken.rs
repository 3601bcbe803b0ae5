//! Histories that cannot be written: of another program, of a newer version, of another rig, locked by another process.

use crate::program::{Workshop, objects};
use crate::serve::Served;
use rusqlite::Connection;
use std::io::{BufRead, BufReader, Read};
use std::time::Duration;

/// Makes the program give up at the first write that fails.
pub fn never_wait(workshop: &Workshop) {
    let rig = workshop.read("config/rig.toml");
    workshop.write(
        "config/rig.toml",
        &format!("{rig}\n[history]\ngive_up_s = 0\n"),
    );
}

const LOT: &str = "run --sim --pace virtual --lot A --recipe jzc-22f-012 --seed 1 --json";

#[test]
fn a_lot_refuses_a_foreign_history_file_untouched() {
    let workshop = Workshop::new("no-history");
    let file = workshop.folder.join("relayrig.db");
    let foreign = || {
        let other = Connection::open(&file).unwrap();
        other
            .execute_batch("CREATE TABLE invoices (id INTEGER)")
            .unwrap();
    };
    let letter =
        || std::fs::write(&file, "this is a letter, not a database\n".repeat(100)).unwrap();
    let cases: [(&dyn Fn(), &str); 2] = [
        (&foreign, "is not a relayrig history (application id 0x0"),
        (&letter, "is not a relayrig history (no SQLite database)"),
    ];
    for (make, reason) in cases {
        let _ = std::fs::remove_file(&file);
        make();
        let before = std::fs::read(&file).unwrap();
        let said = workshop.run(&format!("{LOT} --count 2")).with_status(2);
        assert!(said.stderr.contains(reason), "{said}");
        assert_eq!(said.stdout, "", "no part was judged");
        assert_eq!(std::fs::read(&file).unwrap(), before);
    }
}

#[test]
fn a_lot_refuses_the_history_of_a_newer_program() {
    let workshop = Workshop::new("newer");
    workshop
        .run("history generate --parts 3 --until 2026-01-01T00:00:00Z")
        .with_status(0);
    let by_hand = Connection::open(workshop.folder.join("relayrig.db")).unwrap();
    by_hand.pragma_update(None, "user_version", 99).unwrap();
    drop(by_hand);
    let said = workshop.run(&format!("{LOT} --count 2")).with_status(2);
    assert!(said.stderr.contains("has schema 99"), "{said}");
    assert!(said.stderr.contains("use a newer program"), "{said}");
    assert_eq!(
        (
            said.stdout.as_str(),
            workshop.count("SELECT count(*) FROM part")
        ),
        ("", 3)
    );
}

#[test]
fn real_and_simulated_parts_never_share_a_history() {
    let workshop = Workshop::new("other-rig");
    workshop.run(&format!("{LOT} --count 1")).with_status(0);
    let refused = |words: &str, holds: &str| {
        let said = workshop.run(words).with_status(2);
        let told = format!("relayrig.db is the history of {holds}");
        assert!(said.stderr.contains(&told), "{words}: {said}");
        assert!(said.stderr.contains("--db"), "{words}: {said}");
        assert_eq!(said.stdout, "", "{words}");
    };
    for words in [
        "run --lot B --recipe jzc-22f-012 --count 1",
        "serve --listen 127.0.0.1:0",
        "calibrate",
        "calibrate --verify",
    ] {
        refused(words, "the simulated rig");
    }
    let by_hand = Connection::open(workshop.folder.join("relayrig.db")).unwrap();
    by_hand
        .execute("UPDATE rig SET source = 'rig'", [])
        .unwrap();
    drop(by_hand);
    for words in [
        LOT,
        "serve --listen 127.0.0.1:0 --sim",
        "--db relayrig.db demo --listen 127.0.0.1:0",
        "calibrate --sim",
        "history generate --parts 3",
    ] {
        refused(words, "a real rig");
    }
    workshop.write("old.csv", "operate_voltage_v\n7.5\n");
    workshop
        .run("history import old.csv --lot old")
        .with_status(0);
    workshop.run("history list").with_status(0);
    assert_eq!(workshop.count("SELECT count(*) FROM run"), 2);
}

#[test]
fn a_demo_has_a_history_of_its_own() {
    let workshop = Workshop::new("demo-history");
    let mut demo = workshop.start_logging("demo --listen 127.0.0.1:0");
    let mut told = BufReader::new(demo.stderr.take().unwrap());
    let mut text = String::new();
    while !text.contains("history in relayrig-demo.db") {
        assert!(told.read_line(&mut text).unwrap() > 0, "{text}");
    }
    demo.kill().unwrap();
    demo.wait().unwrap();
    assert!(!workshop.has("relayrig.db"));
}

#[test]
fn a_lock_during_a_lot_clears_at_the_page() {
    let workshop = Workshop::new("lock-cleared");
    let served = Served::start(&workshop, "--sim --speed 100");
    served.until_state("Stopped");
    served.start_lot("A", 12);
    served.until("judged", |view| view["judged"].as_u64() >= Some(2));
    let other = Connection::open(workshop.folder.join("relayrig.db")).unwrap();
    other.busy_timeout(Duration::from_secs(60)).unwrap();
    other.execute_batch("BEGIN IMMEDIATE").unwrap();
    served.until_history_lost("locked by another process");
    other.execute_batch("ROLLBACK").unwrap();
    served.resume();
    served.until_complete("A", 12);
    assert_eq!(served.interrupted(), 0);
    all_landed(&workshop, 12);
}

/// Checks that lot A has this many parts, each once and in its bin.
pub fn all_landed(workshop: &Workshop, parts: i64) {
    let rows = "SELECT count(*) FROM part WHERE kind = 'lot' AND landed_bin = bin";
    assert_eq!(workshop.count(rows), parts);
    assert_eq!(
        workshop.count("SELECT count(*) FROM part WHERE kind = 'lot'"),
        parts
    );
    assert_eq!(workshop.count("SELECT count(*) FROM run"), 1);
    assert_eq!(workshop.texts("SELECT state FROM lot_state"), ["complete"]);
    workshop.run("history check").with_status(0);
}

#[test]
fn a_locked_history_stops_feeding_and_loses_no_part() {
    let workshop = Workshop::new("locked");
    never_wait(&workshop);
    let mut lot = workshop.start_heard(LOT);
    let mut out = BufReader::new(lot.stdout.take().unwrap());
    let mut told = String::new();
    for _ in 0..3 {
        assert!(
            out.read_line(&mut told).unwrap() > 0,
            "the lot ended by itself"
        );
    }
    let other = Connection::open(workshop.folder.join("relayrig.db")).unwrap();
    other.busy_timeout(Duration::from_secs(60)).unwrap();
    other.execute_batch("BEGIN IMMEDIATE").unwrap();
    out.read_to_string(&mut told).unwrap();
    let mut said = String::new();
    lot.stderr
        .take()
        .unwrap()
        .read_to_string(&mut said)
        .unwrap();
    assert_eq!(lot.wait().unwrap().code(), Some(3), "{said}");
    assert!(
        said.contains("the history is locked by another process"),
        "{said}"
    );
    other.execute_batch("ROLLBACK").unwrap();
    let landed = workshop.landed_parts_with_rows(&objects(&told));
    assert!(landed >= 3, "{told}");
    workshop.run("history check").with_status(0);
    workshop.run(&format!("{LOT} --count 2")).with_status(0);
}
