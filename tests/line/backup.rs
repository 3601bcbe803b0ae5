//! A backup of the whole rig, restored by the steps of `docs/installing.md`.

use crate::program::Workshop;
use std::fs;
use std::path::PathBuf;

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

    let said = workshop.run("history restore backups").with_status(0);
    assert!(said.stdout.contains("3 parts; whole"), "{said}");
    assert!(
        said.stdout.contains("people: 1, of them engineers 0"),
        "{said}"
    );
    workshop.run("history check").with_status(0);
    assert_eq!(answers(&workshop), expected);
    assert!(workshop.read("config/lot.toml").contains("# ours"));
    workshop.run(&lot.replace("lot A", "lot B")).with_status(0);
}

#[test]
fn a_restored_rig_keeps_what_was_replaced() {
    let workshop = Workshop::new("replaced");
    let lot = "run --sim --lot A --recipe jzc-22f-012 --count 1 --seed 1";
    workshop.run(lot).with_status(0);
    workshop.run("history backup --into backups").with_status(0);
    workshop.run(&lot.replace("lot A", "lot B")).with_status(0);
    let said = workshop.run("history restore backups").with_status(2);
    assert!(said.stderr.contains("--replace"), "{said}");
    workshop
        .run("history restore backups --replace")
        .with_status(0);
    assert_eq!(workshop.count("SELECT count(*) FROM run"), 1);
    let files = fs::read_dir(&workshop.folder).unwrap();
    let kept = files
        .map(|it| it.unwrap().file_name().into_string().unwrap())
        .filter(|name| name.contains(".before-"));
    let mut kept: Vec<String> = kept.collect();
    kept.sort();
    let [config, db] = kept.as_slice() else {
        panic!("{kept:?}")
    };
    assert!(config.starts_with("config.") && db.starts_with("relayrig.db."));
    let list = workshop.run(&format!("--db {db} history list"));
    assert!(list.with_status(0).stdout.contains("B  "));
}

#[test]
fn a_damaged_backup_is_not_restored() {
    let workshop = Workshop::new("damaged-backup");
    let lot = "run --sim --lot A --recipe jzc-22f-012 --count 1 --seed 1";
    workshop.run(lot).with_status(0);
    workshop.run("history backup --into backups").with_status(0);
    let backup = only_backup(&workshop);
    let recipe = backup.join("config/recipes/jzc-22f-012.toml");
    let text = fs::read_to_string(&recipe).unwrap();
    fs::write(&recipe, format!("{text}\nnonsense = 1\n")).unwrap();
    let history = backup.join("relayrig.db");
    let mut bytes = fs::read(&history).unwrap();
    bytes.truncate(bytes.len() / 2);
    fs::write(&history, bytes).unwrap();
    let said = workshop
        .run("history restore backups --replace")
        .with_status(1);
    for fault in ["history: FAULT", "configuration: FAULT", "nonsense"] {
        assert!(said.stdout.contains(fault), "{fault}: {said}");
    }
    assert!(!workshop.has("relayrig.db.restoring"));
    workshop.run("history check").with_status(0);
}

/// An open connection to the history file takes the place of a running rig.
#[test]
fn a_history_in_use_is_not_replaced() {
    let workshop = Workshop::new("in-use");
    let lot = "run --sim --lot A --recipe jzc-22f-012 --count 1 --seed 1";
    workshop.run(lot).with_status(0);
    workshop.run("history backup --into backups").with_status(0);
    let open = rusqlite::Connection::open(workshop.folder.join("relayrig.db")).unwrap();
    let runs = || open.query_row("SELECT count(*) FROM run", [], |row| row.get::<_, i64>(0));
    assert_eq!(runs().unwrap(), 1);
    let said = workshop
        .run("history restore backups --replace")
        .with_status(2);
    assert!(said.stderr.contains("in use"), "{said}");
    assert_eq!(runs().unwrap(), 1);
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
