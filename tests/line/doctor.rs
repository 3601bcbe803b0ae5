//! `doctor` on a fresh folder, and on spoiled ones.

use crate::program::Workshop;
use serde_json::Value;
use std::fs::{self, Permissions};
use std::os::unix::fs::{PermissionsExt, symlink};

/// Lines of a rig whose ports exist: each port is a character device.
const PORTS: &str = "--line measure=ports/measure --line motion=ports/motion";

/// A folder with two ports.
fn workshop(name: &str) -> Workshop {
    let workshop = Workshop::new(name);
    let ports = workshop.folder.join("ports");
    fs::create_dir(&ports).unwrap();
    symlink("/dev/null", ports.join("measure")).unwrap();
    symlink("/dev/zero", ports.join("motion")).unwrap();
    workshop
}

/// Runs the doctor; returns its exit status and the findings of one check.
fn examined(workshop: &Workshop, words: &str, check: &str) -> (i32, Vec<Value>) {
    let said = workshop.run(&format!("doctor --json {words}"));
    let mut found = said.objects();
    let summary = found.pop().unwrap();
    assert_eq!(summary["type"], "summary", "{said}");
    assert_eq!(summary["fault"] == 0, said.status == 0, "{said}");
    for finding in &found {
        let is_healthy = finding["health"] == "ok";
        assert_eq!(finding["remedy"].is_null(), is_healthy, "{finding}");
    }
    found.retain(|it| it["check"] == check);
    (said.status, found)
}

/// Checks that the doctor reports one fault of this check, and that its text contains `part`.
fn assert_fault(workshop: &Workshop, words: &str, (check, part): (&str, &str)) {
    let (status, found) = examined(workshop, words, check);
    assert_eq!(status, 1);
    let mut faults = found.iter().filter(|it| it["health"] == "fault");
    let fault = faults
        .next()
        .unwrap_or_else(|| panic!("no fault: {found:?}"));
    assert!(fault["found"].as_str().unwrap().contains(part), "{fault}");
    assert_eq!(faults.next(), None);
}

/// Makes the history of a real rig with one calibration, by the simulated rig.
fn calibrated(workshop: &Workshop) {
    workshop.run("calibrate --sim").with_status(0);
    let sql = "UPDATE calibration SET body = json_set(body, '$.simulated', json('false'));
               UPDATE rig SET source = 'rig';";
    change_history(workshop, sql);
}

fn change_history(workshop: &Workshop, sql: &str) {
    let history = rusqlite::Connection::open(workshop.folder.join("relayrig.db")).unwrap();
    history.execute_batch(sql).unwrap();
}

#[test]
fn a_fresh_folder_has_no_fault_and_stays_unchanged() {
    let workshop = workshop("doctor");
    let (status, history) = examined(&workshop, PORTS, "history");
    assert_eq!(status, 0);
    assert_eq!(history[0]["found"], "none yet; the first run makes it");
    let (_, configuration) = examined(&workshop, PORTS, "configuration");
    assert_eq!(configuration[0]["subject"], "config");
    assert!(!workshop.has("relayrig.db"));
    let said = workshop.run(&format!("doctor {PORTS}")).with_status(0);
    let ports = said
        .stdout
        .lines()
        .filter(|line| line.starts_with("ok       port "));
    assert_eq!(ports.count(), 2, "{said}");
}

#[test]
fn a_calibrated_rig_is_healthy() {
    let workshop = workshop("doctor-calibrated");
    calibrated(&workshop);
    let (status, found) = examined(&workshop, PORTS, "calibration");
    assert_eq!((status, found.len()), (0, 1), "{found:?}");
    assert_eq!(found[0]["subject"], "12 V");
}

#[cfg(unix)]
#[test]
fn a_closed_pipe_keeps_the_exit_status() {
    let workshop = workshop("doctor-unread");
    let missing = "doctor --line measure=ports/none --line motion=ports/motion";
    workshop.run_unread(missing).with_status(1);
}

#[test]
fn a_missing_port_is_a_fault() {
    let workshop = workshop("doctor-port");
    fs::remove_file(workshop.folder.join("ports/motion")).unwrap();
    assert_fault(&workshop, PORTS, ("port", "nothing"));
}

#[test]
fn one_port_of_two_lines_is_a_fault() {
    let workshop = workshop("doctor-twin");
    let words = "--line measure=ports/motion --line motion=ports/motion";
    assert_fault(&workshop, words, ("port", "the port of line measure too"));
}

#[test]
fn an_overdue_calibration_is_a_fault() {
    let workshop = workshop("doctor-overdue");
    calibrated(&workshop);
    let later = "UPDATE calibration SET made_at_us = made_at_us - 172800000000,
                 due_at_us = due_at_us - 172800000000";
    change_history(&workshop, later);
    assert_fault(&workshop, PORTS, ("calibration", "overdue for"));
}

#[test]
fn a_calibration_that_failed_its_verification_is_a_fault() {
    let workshop = workshop("doctor-failed");
    calibrated(&workshop);
    change_history(&workshop, "UPDATE calibration SET verified = 0");
    let expected = ("calibration", "failed its verification");
    assert_fault(&workshop, PORTS, expected);
}

#[test]
fn a_read_only_history_is_a_fault() {
    let workshop = workshop("doctor-read-only");
    calibrated(&workshop);
    let file = workshop.folder.join("relayrig.db");
    fs::set_permissions(file, Permissions::from_mode(0o444)).unwrap();
    assert_fault(&workshop, PORTS, ("history", "0444"));
}

#[test]
fn a_damaged_history_is_a_fault() {
    let workshop = workshop("doctor-damaged");
    calibrated(&workshop);
    change_history(&workshop, "PRAGMA wal_checkpoint(TRUNCATE)");
    let file = workshop.folder.join("relayrig.db");
    let mut bytes = fs::read(&file).unwrap();
    let length = bytes.len();
    bytes[length / 4..length / 2].fill(0xA5);
    fs::write(&file, bytes).unwrap();
    let (status, found) = examined(&workshop, PORTS, "history");
    assert_eq!((status, &found[0]["health"]), (1, &"fault".into()));
    workshop.write(
        "relayrig.db",
        "no database at all, but long enough for a header of a page",
    );
    assert_fault(&workshop, PORTS, ("history", "no SQLite database"));
}

#[test]
fn a_wrong_configuration_is_a_fault() {
    let workshop = workshop("doctor-config");
    workshop.change("config/rig.toml", "heartbeat_ms = 300", "heartbeat_ms = -1");
    assert_fault(&workshop, PORTS, ("configuration", "heartbeat_ms"));
}

#[test]
fn the_list_of_people_must_be_private() {
    let workshop = workshop("doctor-people");
    workshop.run("user add li --role operator").with_status(0);
    let (_, people) = examined(&workshop, PORTS, "people");
    assert_eq!(people[0]["health"], "ok");
    let file = workshop.folder.join("relayrig-access.db");
    fs::set_permissions(file, Permissions::from_mode(0o644)).unwrap();
    let (status, people) = examined(&workshop, PORTS, "people");
    assert_eq!((status, &people[0]["health"]), (0, &"warning".into()));
}

#[test]
fn a_history_of_an_older_schema_is_not_migrated() {
    let workshop = workshop("doctor-older");
    calibrated(&workshop);
    change_history(&workshop, "PRAGMA user_version = 10");
    let (status, found) = examined(&workshop, PORTS, "history");
    assert_eq!(status, 0);
    assert!(found[0]["found"].as_str().unwrap().contains("schema 10"));
    let still = rusqlite::Connection::open(workshop.folder.join("relayrig.db")).unwrap();
    let schema = still.pragma_query_value(None, "user_version", |row| row.get::<_, i64>(0));
    assert_eq!(schema.unwrap(), 10);
}

#[test]
fn a_missing_configuration_is_one_fault_with_its_remedy() {
    let workshop = Workshop::empty("doctor_empty");
    let said = workshop.run("doctor --sim").with_status(1);
    let fault = "config: found no such folder, expected a configuration\n         do: `relayrig init config`";
    assert!(said.stdout.contains(fault), "{said}");
}
