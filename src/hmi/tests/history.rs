//! The history over HTTP.

use super::*;
use crate::history::{Identity, LotRecord, MeasurementRecord, PartRecord, Row, Store};

const KEY: &str = "operate_voltage_v";

/// A lot `A` of `parts` parts with 7.00 V, 7.01 V and so on; each fifth one fails.
fn with_parts(parts: u64) -> Bench {
    let bench = Bench::new();
    let identity = Identity {
        program: "test".into(),
        version: "1".into(),
    };
    let mut store = Store::open(&bench.db, &identity).unwrap();
    let lot = LotRecord {
        lot: "A".into(),
        recipe: "r".into(),
        ..LotRecord::default()
    };
    store.begin_lot(&lot).unwrap();
    let rows: Vec<Row> = (1..=parts).map(|seq| Row::Part(part(seq))).collect();
    store.record(&rows).unwrap();
    bench
}

fn part(seq: u64) -> PartRecord {
    let verdict = if seq.is_multiple_of(5) {
        "fail"
    } else {
        "pass"
    };
    PartRecord {
        lot: "A".into(),
        seq,
        verdict: verdict.into(),
        bin: "pass".into(),
        judged_at_us: i64::try_from(seq).unwrap() * 1_000_000,
        kind: "lot".into(),
        measurements: vec![MeasurementRecord {
            key: KEY.into(),
            value: Some(7.0 + seq as f64 / 100.0),
            uncertainty: Some(0.01),
            high: Some(9.0),
            verdict: verdict.into(),
            attempt: 1,
            ..MeasurementRecord::default()
        }],
        ..PartRecord::default()
    }
}

#[tokio::test]
async fn query_gives_the_parts_that_the_filter_leaves() {
    let bench = with_parts(20);
    let all = bench.get("/api/history/query").await.json();
    assert_eq!(all.as_array().unwrap().len(), 20);
    assert_eq!(all[0]["values"][KEY], 7.01);
    let path = "/api/history/query?lot=A&verdict=fail&param=operate_voltage_v&min=7.1&limit=2";
    let some = bench.get(path).await.json();
    let seqs: Vec<_> = some
        .as_array()
        .unwrap()
        .iter()
        .map(|it| it["seq"].as_u64())
        .collect();
    assert_eq!(seqs, [Some(10), Some(15)]);
    let since = "/api/history/query?since=1970-01-01T08:00:19%2B08:00";
    assert_eq!(bench.get(since).await.json().as_array().unwrap().len(), 2);
    assert_eq!(
        bench.get("/api/history/query?lot=B").await.json(),
        serde_json::json!([])
    );
}

#[tokio::test]
async fn an_answer_of_many_pieces_is_whole() {
    let bench = with_parts(1000);
    let answer = bench.get("/api/history/query").await;
    assert!(answer.body.len() > 200_000);
    let parts = answer.json();
    assert_eq!(parts.as_array().unwrap().len(), 1000);
    assert_eq!(parts[999]["seq"], 1000);
}

#[tokio::test]
async fn list_show_and_stats_agree_with_the_rows() {
    let bench = with_parts(20);
    let lots = bench.get("/api/history/list?lot=A").await.json();
    assert_eq!(
        (&lots[0]["parts"], &lots[0]["fail"]),
        (&20.into(), &4.into())
    );
    let shown = bench.get("/api/history/show?lot=A&seq=7").await.json();
    assert_eq!(shown[0]["measurements"][0]["high"], 9.0);
    let stats = bench
        .get("/api/history/stats?param=operate_voltage_v&lot=A")
        .await
        .json();
    assert_eq!((&stats["n"], &stats["max"]), (&20.into(), &7.2.into()));
    assert!(stats["cpk"].is_number() && stats["cp"].is_null());
}

#[tokio::test]
async fn a_filter_that_cannot_be_meant_is_refused_by_name() {
    let bench = with_parts(1);
    for (query, said) in [
        ("query?lto=A", "lto"),
        ("query?limit=-1", "limit"),
        ("query?limit=x", "limit"),
        ("query?since=yesterday", "RFC 3339"),
        ("query?verdict=good", "pass, fail, void, unjudged"),
        ("query?kind=x", "lot, golden, all"),
        ("query?min=1", "needs param"),
        ("query?param=operate_voltage_v&min=NaN", "finite"),
        ("query?param=operate_voltage_v&min=2&max=1", "above max"),
        ("query?param=nothing", KEY),
        ("list?verdict=pass", "lot, run and recipe only"),
        ("stats", "param"),
        ("stats?param=nothing", KEY),
        ("stats?param=operate_voltage_v&max=1", "range"),
        ("show?lot=A", "seq"),
        ("show?lot=A&seq=1&kind=all", "lot, golden"),
    ] {
        let reason = bench
            .get(&format!("/api/history/{query}"))
            .await
            .refused(400);
        assert!(reason.contains(said), "{query}: {reason}");
    }
}

#[tokio::test]
async fn what_never_was_is_not_found() {
    let bench = with_parts(1);
    let path = "/api/history/stats?param=operate_voltage_v&lot=B";
    assert!(bench.get(path).await.refused(404).contains("no run"));
    let path = "/api/history/show?lot=A&seq=2";
    assert!(bench.get(path).await.refused(404).contains("no lot part 2"));
    let path = "/api/history/show?lot=A'--&seq=18446744073709551615";
    bench.get(path).await.refused(404);
}

#[tokio::test]
async fn without_a_history_file_there_is_none_and_none_is_made() {
    let bench = Bench::new();
    for route in [
        "query",
        "list",
        "show?lot=A&seq=1",
        "stats?param=operate_voltage_v",
    ] {
        let reason = bench
            .get(&format!("/api/history/{route}"))
            .await
            .refused(404);
        assert!(reason.contains("run a lot"), "{reason}");
    }
    assert!(!bench.db.exists());
}

#[tokio::test]
async fn a_file_of_another_program_is_an_error_and_stays_as_it_is() {
    let bench = Bench::new();
    std::fs::write(&bench.db, "no database").unwrap();
    assert!(
        bench
            .get("/api/history/list")
            .await
            .refused(500)
            .contains("not a relayrig history")
    );
    assert_eq!(std::fs::read(&bench.db).unwrap(), b"no database");
}
