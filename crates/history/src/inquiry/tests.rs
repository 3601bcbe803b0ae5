//! Tests of inquiries and their answers.
#![allow(clippy::unwrap_used)]

use crate::Part;
use crate::columns::{COLUMNS, header, row};

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
