//! Tests of the history, one file per subject.
#![allow(clippy::unwrap_used)]

mod approval;
mod external;
mod gates;
mod inquiring;
mod migrating;
mod plans;
mod reading;
mod rejudging;
mod safety;
mod scans;
mod side_by_side;
mod spreadsheet;
mod suspects;
mod tooling;
mod writing;

use super::*;
use machine::dut::Reason;
use std::path::PathBuf;

/// A history file in a temporary folder, which is deleted with this value.
struct File {
    path: PathBuf,
    _folder: tempfile::TempDir,
}

impl File {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        Self {
            path: folder.path().join("history.db"),
            _folder: folder,
        }
    }
    fn store(&self) -> Store {
        Store::open(&self.path).unwrap()
    }
    fn archive(&self) -> Archive {
        Archive::open(&self.path).unwrap()
    }
    /// Opens the file with SQLite alone, as any other program would.
    fn by_hand(&self) -> rusqlite::Connection {
        rusqlite::Connection::open(&self.path).unwrap()
    }
}

fn lot(name: &str) -> LotRecord {
    let recipe_snapshot = "name = \"jzc-22f-012\"\n".to_owned();
    LotRecord {
        lot: name.into(),
        recipe: "jzc-22f-012".into(),
        recipe_hash: snapshot_hash(&recipe_snapshot),
        recipe_snapshot,
        opened_at_us: 1_000_000,
        simulated: true,
        seed: Some(u64::MAX),
        ..LotRecord::default()
    }
}

/// Returns a part with two parameters: a coil resistance of 400 ohm plus `seq`, and the operate voltage `operate_v`.
fn part(lot: &str, seq: u64, verdict: &str, operate_v: f64) -> PartRecord {
    PartRecord {
        lot: lot.into(),
        seq,
        verdict: verdict.into(),
        bin: if verdict == "pass" { "pass" } else { "voltage" }.into(),
        reasons: if verdict == "pass" {
            vec![]
        } else {
            vec![Reason::from_text("operate_voltage_v high")]
        },
        judged_at_us: 1_000_000 * i64::try_from(seq).unwrap(),
        test_s: 0.61,
        kind: "lot".into(),
        measurements: vec![
            measurement("coil_resistance_ohm", 400.0 + seq as f64, 1),
            measurement("operate_voltage_v", operate_v, 1),
        ],
        ..PartRecord::default()
    }
}

fn measurement(key: &str, value: f64, attempt: u32) -> MeasurementRecord {
    MeasurementRecord {
        key: key.into(),
        value: Some(value),
        uncertainty: Some(0.02),
        high: Some(9.0),
        verdict: "pass".into(),
        attempt,
        budget: Some("{\"gain\":0.01}".into()),
        samples: vec![SampleRecord {
            line: "measure".into(),
            module: "01".into(),
            channel: "0".into(),
            command: "#010".into(),
            raw: ">4C53".into(),
            at_us: 999_000,
        }],
        ..MeasurementRecord::default()
    }
}

/// Writes a lot of `count` parts whose operate voltage is 7 V plus `seq` millivolts; every tenth part fails.
fn filled(file: &File, count: u64) -> Store {
    let mut store = file.store();
    store.begin_lot(&lot("A")).unwrap();
    let rows: Vec<Row> = (1..=count)
        .map(|seq| {
            let verdict = if seq % 10 == 0 { "fail" } else { "pass" };
            Row::Part(part("A", seq, verdict, 7.0 + seq as f64 / 1000.0))
        })
        .collect();
    store.record(&rows).unwrap();
    store
}

fn count(connection: &rusqlite::Connection, table: &str) -> i64 {
    connection
        .query_row(&format!("SELECT count(*) FROM {table}"), [], |row| {
            row.get(0)
        })
        .unwrap()
}

/// Returns parts 1 to `count`; part n is judged at second n.
fn parts(name: &str, count: u64) -> Vec<Row> {
    let one = |seq| Row::Part(part(name, seq, "pass", 7.0));
    (1..=count).map(one).collect()
}
