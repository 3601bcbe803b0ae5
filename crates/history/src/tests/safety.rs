//! Tests: owner and schema of a history file, and which rows survive a failure.

use super::*;

#[test]
fn a_foreign_file_is_refused_untouched() {
    let file = File::new();
    file.by_hand()
        .execute_batch("CREATE TABLE invoices (id INTEGER)")
        .unwrap();
    let before = std::fs::read(&file.path).unwrap();
    let refusal = Store::open(&file.path).unwrap_err();
    assert!(matches!(refusal, HistoryError::Foreign { .. }), "{refusal}");
    assert!(matches!(
        Archive::open(&file.path),
        Err(HistoryError::Foreign { .. })
    ));
    assert_eq!(std::fs::read(&file.path).unwrap(), before);
}

#[test]
fn a_non_database_file_is_refused_untouched() {
    let file = File::new();
    let text = "this is a letter, not a database\n".repeat(100);
    std::fs::write(&file.path, &text).unwrap();
    let refusal = Store::open(&file.path).unwrap_err();
    assert!(
        refusal.to_string().contains("no SQLite database"),
        "{refusal}"
    );
    assert_eq!(std::fs::read_to_string(&file.path).unwrap(), text);
}

#[test]
fn a_newer_schema_is_refused_with_both_numbers() {
    let file = File::new();
    drop(file.store());
    file.by_hand()
        .pragma_update(None, "user_version", SCHEMA + 1)
        .unwrap();
    let refusal = Store::open(&file.path).unwrap_err();
    assert!(matches!(refusal, HistoryError::Newer { found, known, .. } if found == known + 1));
    assert!(matches!(
        Archive::open(&file.path),
        Err(HistoryError::Newer { .. })
    ));
}

#[test]
fn reading_what_was_never_written_makes_no_file() {
    let file = File::new();
    assert!(matches!(
        Archive::open(&file.path),
        Err(HistoryError::Missing { .. })
    ));
    assert!(!file.path.exists());
}

#[test]
fn a_file_locked_elsewhere_is_an_error_by_name() {
    let file = File::new();
    let mut store = file.store();
    store.impatient();
    let other = file.by_hand();
    other.execute_batch("BEGIN IMMEDIATE").unwrap();
    let refusal = store.begin_lot(&lot("A")).unwrap_err();
    assert_eq!(
        refusal.to_string(),
        "opening the lot: the history is locked by another process"
    );
    other.execute_batch("ROLLBACK").unwrap();
    store.begin_lot(&lot("A")).unwrap();
}

/// A dangling link named `-shm` keeps SQLite from opening the file with write access, as read-only media do.
#[test]
fn read_only_media_open_for_reading() {
    let file = File::new();
    drop(filled(&file, 3));
    let beside = |end: &str| {
        let mut name = file.path.clone().into_os_string();
        name.push(end);
        PathBuf::from(name)
    };
    std::os::unix::fs::symlink("nowhere", beside("-shm")).unwrap();
    let archive = Archive::open(&file.path).unwrap();
    assert_eq!(archive.count_parts(&Filter::default()).unwrap(), 3);
    archive.check().unwrap();
    assert_eq!(examine(&file.path).unwrap().schema, SCHEMA);
    std::fs::write(beside("-wal"), "rows").unwrap();
    let refusal = Archive::open(&file.path).unwrap_err();
    assert!(
        matches!(refusal, HistoryError::Unsettled { .. }),
        "{refusal}"
    );
}

#[test]
fn read_only_file_is_readable_and_names_its_error() {
    let file = File::new();
    let mut store = filled(&file, 10);
    store.read_only(true);
    let rows = [Row::Part(part("A", 11, "pass", 7.0))];
    let refusal = store.record(&rows).unwrap_err();
    assert_eq!(refusal.to_string(), "recording: the history is read-only");
    assert!(store.begin_lot(&lot("B")).is_err());
    assert_eq!(file.archive().count_parts(&Filter::default()).unwrap(), 10);
}

#[test]
fn a_failed_batch_is_written_whole_on_retry() {
    let file = File::new();
    let mut store = file.store();
    let batch = [
        Row::Run(lot("A")),
        Row::Part(part("A", 1, "pass", 7.0)),
        Row::Part(part("A", 2, "fail", 9.5)),
    ];
    store.read_only(true);
    for _ in 0..2 {
        assert!(store.record(&batch).is_err());
        assert!(store.close_lot("A", 9_000_000).is_err(), "no run is open");
    }
    store.read_only(false);
    store.record(&batch).unwrap();
    store.read_only(true);
    assert!(store.close_lot("A", 9_000_000).is_err());
    store.read_only(false);
    store.close_lot("A", 9_000_000).unwrap();
    let runs = file.archive().lots(&Filter::default()).unwrap();
    let [run] = &runs[..] else {
        panic!("{} runs", runs.len())
    };
    assert_eq!((run.run, run.counts.parts), (1, 2));
    assert_eq!(run.closed, Some(Moment(9_000_000)));
}

#[test]
fn a_full_disk_names_its_error_and_keeps_rows() {
    let file = File::new();
    let mut store = filled(&file, 10);
    store.forbid_growth();
    let rows: Vec<Row> = (11..500)
        .map(|seq| Row::Part(part("A", seq, "pass", 7.0)))
        .collect();
    let refusal = store.record(&rows).unwrap_err();
    assert!(
        matches!(refusal, HistoryError::DiskFull { .. }),
        "{refusal}"
    );
    assert_eq!(count(&file.by_hand(), "part"), 10);
    file.archive().check().unwrap();
}

#[test]
fn the_file_is_marked_as_ours_and_written_durably() {
    let file = File::new();
    let mut store = file.store();
    let pragma = |name: &str| store.pragma(name);
    assert_eq!(pragma("application_id"), APPLICATION_ID.to_string());
    assert_eq!(pragma("user_version"), SCHEMA.to_string());
    assert_eq!(pragma("journal_mode"), "wal");
    assert_eq!(pragma("synchronous"), "2", "FULL");
    assert_eq!(pragma("foreign_keys"), "1");
    store.trust_the_power().unwrap();
    assert_eq!(store.pragma("synchronous"), "1", "NORMAL");
}

#[test]
fn every_table_is_strict_with_remarked_columns() {
    let file = File::new();
    drop(file.store());
    let by_hand = file.by_hand();
    let mut statement = by_hand
        .prepare("SELECT name, sql FROM sqlite_schema WHERE type = 'table'")
        .unwrap();
    let tables: Vec<(String, String)> = statement
        .query_map([], |row| Ok((row.get(0)?, row.get(1)?)))
        .unwrap()
        .collect::<rusqlite::Result<_>>()
        .unwrap();
    let mut names: Vec<&str> = tables.iter().map(|(name, _)| name.as_str()).collect();
    names.sort_unstable();
    assert_eq!(
        names.join(" "),
        "alarm alarm_state batch batch_curve calibration curve export external_result golden_check inside lot lot_state \
         measurement ordered outbox parameter part reason recipe reopening retest rig row_floor run run_end sample series \
         sqlite_sequence target tooling_plan tooling_step wear"
    );
    let own = tables.iter().filter(|(name, _)| name != "sqlite_sequence");
    for (table, sql) in own {
        assert!(sql.contains(") STRICT"), "{table}");
        let columns = sql.lines().filter(|line| {
            line.starts_with("  ") && line.trim_start().starts_with(|it: char| it.is_lowercase())
        });
        for column in columns {
            assert!(column.contains("-- "), "{table}: {column}");
        }
    }
}

#[test]
fn a_backup_in_use_is_whole_and_never_overwrites() {
    let (file, copy) = (File::new(), File::new());
    let mut store = filled(&file, 25);
    let archive = file.archive();
    assert!(archive.backup(&copy.path).unwrap() > 0);
    store
        .record(&[Row::Part(part("A", 26, "pass", 7.0))])
        .unwrap();
    assert_eq!(copy.archive().query(&Filter::default()).unwrap().len(), 25);
    assert_eq!(
        copy.store().pragma("application_id"),
        APPLICATION_ID.to_string()
    );
    assert!(matches!(
        archive.backup(&copy.path),
        Err(HistoryError::Exists { .. })
    ));
}

#[test]
fn an_uncommitted_batch_leaves_no_row() {
    let file = File::new();
    let store = filled(&file, 5);
    store.begin_and_forget();
    let mut store = file.store();
    assert_eq!(count(&file.by_hand(), "part"), 5);
    assert_eq!(store.begin_lot(&lot("A")).unwrap(), 2);
    file.archive().check().unwrap();
}
