//! Tests of errors against the truth.

use super::super::error::{Errors, Pooled};
use super::super::figure::{Bar, Figure};
use super::{lot, near, row, three_good_one_bad, truth};
use machine::dut::em_relay::Parameter;
use serde_json::json;

#[test]
fn errors_count_good_parts_in_millivolts() {
    let errors = Errors::of(Parameter::OperateVoltage.into(), &three_good_one_bad());
    assert_eq!(errors.n(), 3);
    near(errors.bias(), 0.0);
    near(errors.rms(), (126.0_f64 / 3.0).sqrt());
    near(errors.worst(), 9.0);
}

#[test]
fn the_rms_of_a_single_error_is_its_size() {
    let lot = lot(
        &[row(1, "pass", "pass", 7.996)],
        &[truth(1, None, "pass", 8.0)],
    );
    near(
        Errors::of(Parameter::OperateVoltage.into(), &lot).rms(),
        4.0,
    );
}

#[test]
fn the_coil_error_is_relative_to_the_truth() {
    let mut part = row(1, "pass", "pass", 8.0);
    part["values"]["coil_resistance_ohm"] = json!(402.0);
    let mut known = truth(1, None, "pass", 8.0);
    known["coil_resistance_ohm"] = json!(400.0);
    near(
        Errors::of(Parameter::CoilResistance.into(), &lot(&[part], &[known])).rms(),
        0.5,
    );
}

#[test]
fn an_unmeasured_parameter_misses_its_bar() {
    let errors = Pooled::of(Parameter::ReleaseTime, &[three_good_one_bad()]);
    assert_eq!(
        (errors.n(), errors.median_rms(), errors.coverage_pct()),
        (0, None, None)
    );
    assert_eq!(
        Figure::new("x", 0, None, "ms").bar(Bar::AtMost(1.0)).met(),
        Some(false)
    );
}

#[test]
fn a_lot_without_values_leaves_no_median() {
    let empty = lot(&[], &[]);
    let errors = Pooled::of(Parameter::OperateVoltage, &[three_good_one_bad(), empty]);
    assert_eq!(errors.median_rms(), None);
    near(errors.worst(), 9.0);
}

#[test]
fn coverage_is_pooled_over_parts_not_averaged_over_lots() {
    let outside = lot(
        &[row(1, "pass", "pass", 8.011)],
        &[truth(1, None, "pass", 8.0)],
    );
    let errors = Pooled::of(Parameter::OperateVoltage, &[three_good_one_bad(), outside]);
    near(errors.coverage_pct(), 75.0);
    near(errors.worst_coverage_pct(), 0.0);
}

#[test]
fn a_value_without_an_uncertainty_is_not_covered() {
    let mut bare = row(1, "pass", "pass", 8.0);
    bare["uncertainty"] = json!({"operate_voltage_v": null});
    let lot = lot(&[bare], &[truth(1, None, "pass", 8.0)]);
    near(
        Pooled::of(Parameter::OperateVoltage, &[lot]).coverage_pct(),
        0.0,
    );
}
