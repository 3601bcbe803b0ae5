//! Tests of calibrations and reference parts over HTTP.

use super::*;
use ::history::{
    CalibrationRecord, LotRecord, MeasurementRecord, PartRecord, ReferenceCheckRecord, Row, Store,
    snapshot_hash,
};
use machine::dut::em_relay::Calibration;
use machine::dut::em_relay::calibration::{InputLine, OutputLine};
use machine::gauge::Factor;
use machine::station::catalogue::AlarmCode;
use serde_json::json;

const HOUR_US: i64 = 3_600_000_000;

/// Returns a calibration that was made at `at_us` and is due a day later.
fn made(at_us: i64, simulated: bool, nominal_v: f64) -> CalibrationRecord {
    let known = Factor::new(1.0, 0.001);
    let body = serde_json::to_string(&Calibration {
        made_at_us: at_us,
        due_at_us: at_us + 24 * HOUR_US,
        simulated,
        nominal_v,
        coil_input: InputLine {
            gain: known,
            offset_v: known,
        },
        ohm_fine: known,
        ohm_wide: known,
        ohm_high: None,
        range_factor: 1.0,
        contact_mohm_per_v: known,
        gate_delay_us: [known; 2],
        level: OutputLine::IDEAL,
        coarse: OutputLine::IDEAL,
        fine: OutputLine::IDEAL,
        coarse_v_per_s: known,
        fine_v_per_s: known,
        overshoots: None,
        temperature: None,
        probe_contact_ohm: 0.0,
        broken: Vec::new(),
    });
    let body = body.unwrap();
    CalibrationRecord {
        made_at_us: at_us,
        due_at_us: at_us + 24 * HOUR_US,
        hash: snapshot_hash(&body),
        body,
        verified: true,
    }
}

fn golden(seq: u64, at_us: i64, uncertainty: Option<f64>) -> PartRecord {
    PartRecord {
        lot: "A".into(),
        seq,
        serial: Some("G-12-1".into()),
        verdict: "void".into(),
        bin: "retest".into(),
        kind: "golden".into(),
        judged_at_us: at_us,
        measurements: vec![MeasurementRecord {
            key: "operate_voltage_v".into(),
            value: Some(7.41),
            uncertainty,
            verdict: "void".into(),
            attempt: 1,
            ..MeasurementRecord::default()
        }],
        ..PartRecord::default()
    }
}

fn fixture(rows: &[Row], calibrations: &[CalibrationRecord]) -> Fixture {
    let fixture = Fixture::new();
    let mut store = Store::open(&fixture.db).unwrap();
    for calibration in calibrations {
        store.save_calibration(calibration).unwrap();
    }
    let lot = LotRecord {
        lot: "A".into(),
        recipe: "r".into(),
        simulated: true,
        ..LotRecord::default()
    };
    store.begin_lot(&lot).unwrap();
    store.record(rows).unwrap();
    fixture
}

#[tokio::test]
async fn each_coil_has_its_latest_calibration_overdue_when_expired() {
    let now_us = jiff::Timestamp::now().as_microsecond();
    let foreign = CalibrationRecord {
        body: r#"{"simulated":true,"nominal_v":24.0,"written":"otherwise"}"#.into(),
        ..made(now_us, true, 24.0)
    };
    let fixture = fixture(
        &[],
        &[
            made(now_us - 2 * HOUR_US, true, 12.0),
            made(now_us - HOUR_US, true, 12.0),
            made(now_us - 30 * HOUR_US, true, 6.0),
            made(now_us, false, 12.0),
            foreign,
        ],
    );
    let answer = fixture.get("/api/calibration").await.json();
    let held = answer["calibrations"].as_array().unwrap();
    let facts: Vec<_> = held
        .iter()
        .map(|it| {
            (
                it["nominal_v"].as_f64().unwrap(),
                it["overdue"].as_bool().unwrap(),
            )
        })
        .collect();
    assert_eq!(
        facts,
        [(6.0, true), (12.0, false), (24.0, false)],
        "the real rig's own is not the simulated one's"
    );
    let factors = held[1]["factors"].as_array().unwrap();
    assert_eq!(
        factors[0],
        json!({"name": "coil_input_gain", "unit": "1", "value": 1.0, "uncertainty": 0.002})
    );
    assert_eq!(
        held[2]["factors"],
        json!([]),
        "written by a program of another kind"
    );
    let hour_ago = ::history::Moment(now_us - HOUR_US).to_string();
    assert_eq!(held[1]["made"], hour_ago);
}

#[tokio::test]
async fn a_reference_part_has_certificate_and_last_reading() {
    let check = Row::ReferenceCheck(ReferenceCheckRecord {
        lot: "A".into(),
        at_us: 7_000_000,
        text: "G-12-1 high".into(),
        failure: Some(AlarmCode::ReferenceCheckFailed.into()),
    });
    let rows = [
        Row::Part(golden(1, 4_000_000, Some(0.5))),
        Row::Part(golden(2, 5_000_000, Some(0.01))),
        check,
    ];
    let answer = fixture(&rows, &[]).get("/api/calibration").await.json();
    let first = &answer["golden"][0];
    assert_eq!(
        (&first["serial"], &first["run"]),
        (&json!("G-12-1"), &json!(["A", 1]))
    );
    assert_eq!(first["seen"], "1970-01-01T00:00:05.000000Z");
    assert_eq!(
        first["values"][0],
        json!({"parameter": "operate_voltage_v", "certified": 7.4, "certified_uncertainty": 0.002, "value": 7.41,
            "uncertainty": 0.01})
    );
    assert_eq!(answer["golden"][1]["seen"], json!(null));
    assert_eq!(
        (&answer["check"]["passed"], &answer["check"]["text"]),
        (&json!(false), &json!("G-12-1 high"))
    );
}

#[tokio::test]
async fn readings_for_the_overshoot_are_not_compared_with_certificates() {
    let rows = [Row::Part(golden(1, 5_000_000, None))];
    let answer = fixture(&rows, &[]).get("/api/calibration").await.json();
    let first = &answer["golden"][0];
    assert_eq!(
        (&first["values"][0]["value"], &answer["check"]),
        (&json!(null), &json!(null))
    );
    assert!(first["seen"].is_string());
}
