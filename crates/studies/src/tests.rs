//! Tests of the arithmetic of the studies, on hand-written rows.
#![allow(clippy::unwrap_used)]

mod errors;
mod parts;
mod tables;
mod times;

use super::figure::Figure;
use super::lot::Lot;
use serde_json::{Value, json};

const SUMMARY: &str = r#"{"type":"summary","alarms":0,"eeprom_writes":0,"bytes":{"measure":"a1"},"ended":"complete"}"#;

fn row(seq: u64, verdict: &str, bin: &str, operate_v: f64) -> Value {
    json!({"type": "part", "seq": seq, "verdict": verdict, "bin": bin, "test_s": 0.5, "cycle_s": 2.0,
        "values": {"operate_voltage_v": operate_v}, "uncertainty": {"operate_voltage_v": 0.010}})
}

fn truth(seq: u64, defect: Option<&str>, landed_in: &str, operate_v: f64) -> Value {
    json!({"seq": seq, "defect": defect, "landed_in": landed_in, "operate_voltage_v": operate_v, "coil_resistance_ohm": null})
}

fn lot(rows: &[Value], truths: &[Value]) -> Lot {
    let lines = |them: &[Value]| them.iter().map(|it| format!("{it}\n")).collect::<String>();
    Lot::read(1, &format!("{}{SUMMARY}\n", lines(rows)), &lines(truths)).unwrap()
}

fn figure<'a>(figures: &'a [Figure], name: &str) -> &'a Figure {
    figures.iter().find(|figure| figure.name == name).unwrap()
}

fn near(found: Option<f64>, expected: f64) {
    let found = found.unwrap();
    assert!(
        (found - expected).abs() < 1e-9,
        "found {found}, expected {expected}"
    );
}

/// Returns a lot with errors of +3, -9 and +6 mV against 8 V on good parts, and a defective part far off.
fn three_good_one_bad() -> Lot {
    let off = [0.003, -0.009, 0.006];
    let mut rows: Vec<Value> = (1..)
        .zip(off)
        .map(|(seq, by)| row(seq, "pass", "pass", 8.0 + by))
        .collect();
    let mut truths: Vec<Value> = (1..=3).map(|seq| truth(seq, None, "pass", 8.0)).collect();
    rows.push(row(4, "fail", "voltage", 9.9));
    truths.push(truth(4, Some("stiff_spring"), "voltage", 9.0));
    lot(&rows, &truths)
}
