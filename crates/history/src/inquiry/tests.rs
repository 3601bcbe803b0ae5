//! Tests of inquiries and their answers.
#![allow(clippy::unwrap_used)]

use super::checks::{only, validate};
use crate::columns::{COLUMNS, header, row};
use crate::{Filter, Part};

#[test]
fn an_unused_member_is_refused_by_name() {
    let filter = Filter {
        lot: Some("A".into()),
        bin: Some("coil".into()),
        ..Filter::default()
    };
    assert!(only(&filter, "list", &["lot", "bin"]).is_ok());
    let refusal = only(&filter, "list", &["lot", "run"]).unwrap_err();
    assert_eq!(refusal.to_string(), "bin: `list` takes lot, run only");
}

#[test]
fn every_member_of_the_filter_has_its_name() {
    let text = r#"{"lot":"A","run":1,"recipe":"r","since":"2026-01-01T00:00:00Z",
        "until":"2026-01-02T00:00:00Z","verdict":"pass","bin":"pass","kind":"lot","param":"p",
        "min":1.0,"max":2.0,"limit":3,"offset":4}"#;
    let filter: Filter = serde_json::from_str(text).unwrap();
    let json: serde_json::Value = serde_json::from_str(text).unwrap();
    let mut members = filter.members();
    members.sort_unstable();
    let names: Vec<&String> = json.as_object().unwrap().keys().collect();
    assert_eq!(members, names);
    assert!(validate(&filter).is_ok());
    assert!(Filter::default().members().is_empty());
}

#[test]
fn a_part_has_one_cell_per_column() {
    let keys = ["operate_voltage_v".to_owned()];
    let mut part = Part::fixture("批次", 7, "fail");
    part = part.with_reasons(["a", "b"].map(machine::dut::Reason::unclassified).into());
    part.values.insert(keys[0].clone(), 7.5.into());
    part.uncertainty.insert(keys[0].clone(), 0.01.into());
    let names = header(&keys);
    let cells: Vec<String> = row(&part, &keys).map(|it| it.to_string()).collect();
    assert_eq!(cells.len(), names.len());
    let under = |name: &str| {
        let at = names.iter().position(|it| it == name).unwrap();
        cells[at].as_str()
    };
    assert_eq!(
        (under("lot"), under("seq"), under("reasons")),
        ("批次", "7", "a; b")
    );
    assert_eq!((under("test_s"), under("serial")), ("", ""));
    assert_eq!(under("operate_voltage_v"), "7.5");
    assert_eq!(under("uncertainty operate_voltage_v"), "0.01");
    let mut unique: Vec<&str> = COLUMNS.iter().map(|it| it.name).collect();
    unique.sort_unstable();
    unique.dedup();
    assert_eq!(unique.len(), COLUMNS.len());
}
