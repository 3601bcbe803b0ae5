//! A backup of the whole rig, restored by the steps of `docs/installing.md`.

use crate::program::Workshop;
use std::fs;
use std::path::{Path, PathBuf};

/// Returns the only backup inside `backups`.
fn only_backup(workshop: &Workshop) -> PathBuf {
    let entries = fs::read_dir(workshop.folder.join("backups")).unwrap();
    let folders: Vec<PathBuf> = entries.map(|it| it.unwrap().path()).collect();
    assert_eq!(folders.len(), 1, "{folders:?}");
    folders[0].clone()
}

/// Answers that a restored rig must give as before.
fn answers(workshop: &Workshop) -> Vec<String> {
    let ask = |line: &str| workshop.run(line).with_status(0).stdout;
    [
        "history show A 2 --json",
        "history list --json",
        "user list",
        "config check",
    ]
    .map(ask)
    .into()
}

fn copy(from: &Path, to: &Path) {
    let copied = std::process::Command::new("cp")
        .arg("-a")
        .args([from, to])
        .status();
    assert!(copied.unwrap().success());
}

#[test]
fn a_restored_backup_gives_the_same_answers() {
    let workshop = Workshop::new("restored");
    let lot = "run --sim --lot A --recipe jzc-22f-012 --count 3 --seed 1";
    workshop.run(lot).with_status(0);
    workshop.run("user add li --role operator").with_status(0);
    workshop.change(
        "config/lot.toml",
        "at_start = false",
        "at_start = false # ours",
    );
    let expected = answers(&workshop);
    workshop
        .run("history backup --into backups --keep 1")
        .with_status(0);

    let lost = [
        "relayrig.db",
        "relayrig.db-wal",
        "relayrig.db-shm",
        "relayrig-access.db",
    ];
    for file in lost.iter().filter(|it| workshop.has(it)) {
        fs::remove_file(workshop.folder.join(file)).unwrap();
    }
    fs::remove_dir_all(workshop.folder.join("config")).unwrap();

    let backup = only_backup(&workshop);
    let db = backup.join("relayrig.db");
    let check = format!("--db {} history check", db.display());
    workshop.run(&check).with_status(0);
    for name in ["relayrig.db", "relayrig-access.db", "config"] {
        copy(&backup.join(name), &workshop.folder.join(name));
    }
    workshop.run("history check").with_status(0);
    assert_eq!(answers(&workshop), expected);
    assert!(workshop.read("config/lot.toml").contains("# ours"));
    workshop.run(&lot.replace("lot A", "lot B")).with_status(0);
}

#[test]
fn a_rotating_backup_permits_no_pruning() {
    let workshop = Workshop::new("rotating");
    let lot = "run --sim --lot A --recipe jzc-22f-012 --count 1 --seed 1";
    workshop.run(lot).with_status(0);
    workshop.run("history backup --into backups").with_status(0);
    workshop
        .run("history prune --older-than-days 0 --yes")
        .with_status(0);
    assert_eq!(
        workshop.count("SELECT count(*) FROM part WHERE kind = 'lot'"),
        1
    );
}

#[test]
fn a_failed_backup_leaves_nothing() {
    let workshop = Workshop::new("no-backup");
    let said = workshop.run("history backup --into backups").with_status(2);
    assert!(said.stderr.contains("no history"), "{said}");
    let left = fs::read_dir(workshop.folder.join("backups")).unwrap();
    assert_eq!(left.count(), 0);
}

#[test]
fn a_backup_keeps_an_older_schema() {
    let workshop = Workshop::new("older-schema");
    let lot = "run --sim --lot A --recipe jzc-22f-012 --count 1 --seed 1";
    workshop.run(lot).with_status(0);
    let history = workshop.folder.join("relayrig.db");
    let older = rusqlite::Connection::open(&history).unwrap();
    older.pragma_update(None, "user_version", 10).unwrap();
    workshop.run("history backup --into backups").with_status(0);
    for file in [history, only_backup(&workshop).join("relayrig.db")] {
        let file = rusqlite::Connection::open(file).unwrap();
        let schema = file.pragma_query_value(None, "user_version", |row| row.get::<_, i64>(0));
        assert_eq!(schema.unwrap(), 10);
    }
}
