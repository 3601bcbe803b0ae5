//! Recorded rows: six recipes, five seeds, forty parts each.
//!
//! A change that only moves code leaves every value, uncertainty, verdict, bin and time unchanged. A change of the
//! measurement records the rows again with `RECORD_ROWS=1 cargo test --test line rows`, and its commit gives the
//! reason.
//!
//! A recorded file has a digest of the elementary functions of the computer that made it. With the same digest rows
//! must be equal bit for bit, with another digest numbers may differ by 1e-9.

use crate::program::Workshop;
use rusqlite::{Connection, Row};
use std::fmt::Write as _;
use std::ops::Range;
use std::path::{Path, PathBuf};

const SEEDS: u64 = 5;
const PARTS: u64 = 40;
/// Allowed relative difference with another digest.
const ELSEWHERE: f64 = 1e-9;

#[test]
fn rows_of_the_12_v_recipe_are_as_recorded() {
    compare("jzc-22f-012");
}

#[test]
fn rows_of_the_adaptive_recipe_are_as_recorded() {
    compare("jzc-22f-012-adaptive");
}

#[test]
fn rows_of_the_9_v_recipe_are_as_recorded() {
    compare("jzc-22f-009");
}

#[test]
fn rows_of_the_6_v_recipe_are_as_recorded() {
    compare("jzc-22f-006");
}

#[test]
fn rows_of_the_3_v_recipe_are_as_recorded() {
    compare("jzc-22f-003");
}

#[test]
fn rows_of_the_48_v_recipe_are_as_recorded() {
    compare("jzc-22f-048");
}

fn compare(recipe: &str) {
    let found = measured(recipe);
    let file = recorded_file(recipe);
    if std::env::var_os("RECORD_ROWS").is_some() {
        std::fs::write(&file, &found).unwrap();
    }
    let recorded = std::fs::read_to_string(&file).unwrap();
    let exact = recorded.lines().next() == found.lines().next();
    assert_eq!(found.lines().count(), recorded.lines().count(), "{recipe}");
    for (number, (now, then)) in found.lines().zip(recorded.lines()).enumerate().skip(1) {
        let same = if exact {
            now == then
        } else {
            is_near(now, then)
        };
        assert!(
            same,
            "{recipe}, line {}:\n  now {now}\n then {then}",
            number + 1
        );
    }
}

fn recorded_file(recipe: &str) -> PathBuf {
    let rows = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/line/rows");
    rows.join(format!("{recipe}.txt"))
}

/// Returns all rows of a recipe as text, a line per part, with round-trip numbers.
fn measured(recipe: &str) -> String {
    let workshop = Workshop::new(&format!("rows-{recipe}"));
    let mut text = format!("arithmetic {:016x}\n", arithmetic());
    for seed in 1..=SEEDS {
        let lot = format!("S{seed}");
        workshop
            .run(&format!(
                "--db s{seed}.db run --sim --pace virtual --lot {lot} --recipe {recipe} --count {PARTS} --seed {seed}"
            ))
            .with_status(0);
        let history = Connection::open(workshop.folder.join(format!("s{seed}.db"))).unwrap();
        append_rows(&history, &lot, &mut text);
    }
    text
}

fn append_rows(history: &Connection, lot: &str, text: &mut String) {
    let mut parts = history
        .prepare("SELECT id, kind, seq, verdict, bin, landed_bin, test_s, cycle_s, reasons FROM part ORDER BY id")
        .unwrap();
    let mut measurements = history
        .prepare(
            "SELECT parameter.key, value, uncertainty, verdict FROM measurement \
             JOIN parameter ON parameter.id = parameter_id WHERE part_id = ?1 ORDER BY parameter_id, attempt",
        )
        .unwrap();
    let mut rows = parts.query([]).unwrap();
    while let Some(row) = rows.next().unwrap() {
        write!(text, "{lot}").unwrap();
        append_cells(row, 1..9, text);
        let mut measured = measurements.query([row.get::<_, i64>(0).unwrap()]).unwrap();
        while let Some(row) = measured.next().unwrap() {
            append_cells(row, 0..4, text);
        }
        text.push('\n');
    }
}

fn append_cells(row: &Row, columns: Range<usize>, text: &mut String) {
    for column in columns {
        write!(text, " {}", cell(row.get_ref(column).unwrap())).unwrap();
    }
}

fn cell(value: rusqlite::types::ValueRef) -> String {
    use rusqlite::types::ValueRef::{Blob, Integer, Null, Real, Text};
    match value {
        Null => "-".into(),
        Integer(number) => number.to_string(),
        Real(number) => format!("{number:?}"),
        Text(text) | Blob(text) => String::from_utf8_lossy(text).replace(' ', "_"),
    }
}

/// Returns the digest (FNV-1a) of results of elementary functions on this computer.
fn arithmetic() -> u64 {
    let mut digest = 0xcbf2_9ce4_8422_2325_u64;
    for step in 1..=2000_u32 {
        let x = f64::from(step) * 0.013_7;
        for y in [
            x.exp(),
            x.ln(),
            x.sin(),
            x.cos(),
            x.tanh(),
            x.powf(0.37),
            x.atan2(1.7),
            x.cbrt(),
        ] {
            digest = (digest ^ y.to_bits()).wrapping_mul(0x0100_0000_01b3);
        }
    }
    digest
}

fn is_near(now: &str, then: &str) -> bool {
    let (now, then): (Vec<&str>, Vec<&str>) = (now.split(' ').collect(), then.split(' ').collect());
    now.len() == then.len()
        && now.iter().zip(&then).all(|(now, then)| {
            match (now.parse::<f64>(), then.parse::<f64>()) {
                (Ok(now), Ok(then)) => (now - then).abs() <= ELSEWHERE * then.abs().max(1e-3),
                (Ok(_) | Err(_), Ok(_) | Err(_)) => now == then,
            }
        })
}
