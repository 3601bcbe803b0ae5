//! Tests of rejudging over HTTP.

use super::*;
use ::history::{Archive, Filter, LotRecord, MeasurementRecord, PartRecord, Row, Store};
use serde_json::{Value, json};

/// Values of a good part, all but the operate voltage.
const OTHERS: [(&str, f64); 8] = [
    ("coil_resistance_ohm", 400.0),
    ("release_voltage_v", 2.3),
    ("operate_time_ms", 4.7),
    ("release_time_ms", 2.9),
    ("operate_bounce_ms", 0.4),
    ("release_bounce_ms", 0.5),
    ("contact_resistance_no_mohm", 18.0),
    ("contact_resistance_nc_mohm", 22.0),
];

fn part(seq: u64, operate_v: f64) -> PartRecord {
    let values = OTHERS.into_iter().chain([("operate_voltage_v", operate_v)]);
    let measured = |(key, value): (&str, f64)| MeasurementRecord {
        key: key.into(),
        value: Some(value),
        uncertainty: Some(0.02),
        verdict: "pass".into(),
        attempt: 1,
        ..MeasurementRecord::default()
    };
    PartRecord {
        lot: "A".into(),
        seq,
        verdict: "pass".into(),
        bin: "pass".into(),
        kind: "lot".into(),
        measurements: values.map(measured).collect(),
        ..PartRecord::default()
    }
}

/// Creates a server whose history has four parts that passed, one of them above 9 V.
fn fixture() -> Fixture {
    let fixture = Fixture::new();
    let recipe = std::fs::read_to_string("../../config/recipes/jzc-22f-012.toml").unwrap();
    let mut store = Store::open(&fixture.db).unwrap();
    let lot = LotRecord {
        lot: "A".into(),
        recipe: "jzc-22f-012".into(),
        recipe_hash: ::history::snapshot_hash(&recipe),
        recipe_snapshot: recipe,
        ..LotRecord::default()
    };
    store.begin_lot(&lot).unwrap();
    let volts = (1..).zip([7.9, 8.0, 9.5, 8.1]);
    let rows: Vec<Row> = volts
        .map(|(seq, volts)| Row::Part(part(seq, volts)))
        .collect();
    store.record(&rows).unwrap();
    fixture
}

const ASKED: &str = "/api/history/rejudge?lot=A&recipe=jzc-22f-012";

#[tokio::test]
async fn rejudging_lists_parts_then_a_summary_and_writes_nothing() {
    let fixture = fixture();
    let all = fixture.get(ASKED).await;
    assert_eq!(all.headers["content-type"], "application/json");
    let all = all.json();
    let verdicts: Vec<&Value> = all
        .as_array()
        .unwrap()
        .iter()
        .map(|it| &it["verdict"])
        .collect();
    assert_eq!(
        json!(verdicts),
        json!(["pass", "pass", "fail", "pass", null])
    );
    assert_eq!(all[2]["reasons"], json!(["operate_voltage_v high"]));
    assert_eq!(
        (&all[2]["bin"], &all[2]["verdict_was"]),
        (&json!("voltage"), &json!("pass"))
    );
    let changes = json!([{"was": "pass", "now": "fail", "parts": 1}, {"was": "pass", "now": "pass", "parts": 3}]);
    assert_eq!(
        (&all[4]["type"], &all[4]["changes"]),
        (&json!("summary"), &changes)
    );
    let stored = Archive::open(&fixture.db)
        .unwrap()
        .query(&Filter::default())
        .unwrap();
    assert!(stored.iter().all(|it| it.verdict == "pass"));
}

#[tokio::test]
async fn changed_limits_the_answer_to_changed_verdicts() {
    let some = fixture().get(&format!("{ASKED}&changed=true")).await.json();
    let seqs: Vec<&Value> = some
        .as_array()
        .unwrap()
        .iter()
        .map(|it| &it["seq"])
        .collect();
    assert_eq!(seqs, [&json!(3), &Value::Null]);
}

#[tokio::test]
async fn malformed_questions_get_400_and_unknown_things_404() {
    let fixture = fixture();
    for (query, status, reason) in [
        ("lot=B&recipe=jzc-22f-012", 404, "no run has this lot"),
        ("lot=A&recipe=jzc-22f-012&run=2", 404, "no run has this lot"),
        ("lot=A&recipe=..%2Frig", 404, "expected one of"),
        ("lot=A&recipe=jzc-22f-006", 400, "was measured at 12 V"),
        ("lot=A", 400, "recipe"),
        ("recipe=jzc-22f-012", 400, "lot"),
        (
            "lot=A&recipe=jzc-22f-012&changed=perhaps",
            400,
            "true or false",
        ),
        ("lot=A&recipe=jzc-22f-012&verdict=pass", 400, "verdict"),
    ] {
        let said = fixture
            .get(&format!("/api/history/rejudge?{query}"))
            .await
            .refused(status);
        assert!(said.contains(reason), "{query}: {said}");
    }
}
