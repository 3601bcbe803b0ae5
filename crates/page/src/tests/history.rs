//! Tests of the history over HTTP.

use super::*;
use ::history::{AlarmRecord, LotRecord, MeasurementRecord, OrderRecord, PartRecord, Row, Store};
use texts::Message;

const KEY: &str = "operate_voltage_v";

/// Creates a server whose history has a lot `A` of `parts` parts with 7.00 V, 7.01 V and so on; each fifth part fails.
fn with_parts(parts: u64) -> Fixture {
    let fixture = Fixture::new();
    let mut store = Store::open(&fixture.db).unwrap();
    let lot = LotRecord {
        lot: "A".into(),
        recipe: "r".into(),
        ..LotRecord::default()
    };
    store.begin_lot(&lot).unwrap();
    let rows: Vec<Row> = (1..=parts).map(|seq| Row::Part(part(seq))).collect();
    store.record(&rows).unwrap();
    fixture
}

/// Adds lot B, whose values are the first ones of lot A.
fn add_lot_b(fixture: &Fixture, parts: u64) {
    let mut store = Store::open(&fixture.db).unwrap();
    let lot = LotRecord {
        lot: "B".into(),
        recipe: "r".into(),
        ..LotRecord::default()
    };
    store.begin_lot(&lot).unwrap();
    let of_b = |seq| PartRecord {
        lot: "B".into(),
        ..part(seq)
    };
    let rows: Vec<Row> = (1..=parts).map(|seq| Row::Part(of_b(seq))).collect();
    store.record(&rows).unwrap();
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
async fn query_returns_the_parts_that_match_the_filter() {
    let fixture = with_parts(20);
    let all = fixture.get("/api/history/query").await.json();
    assert_eq!(all.as_array().unwrap().len(), 20);
    assert_eq!(all[0]["values"][KEY], 7.01);
    let path = "/api/history/query?lot=A&verdict=fail&param=operate_voltage_v&min=7.1&limit=2";
    let some = fixture.get(path).await.json();
    let seqs: Vec<_> = some
        .as_array()
        .unwrap()
        .iter()
        .map(|it| it["seq"].as_u64())
        .collect();
    assert_eq!(seqs, [Some(10), Some(15)]);
    let since = "/api/history/query?since=1970-01-01T08:00:19%2B08:00";
    assert_eq!(fixture.get(since).await.json().as_array().unwrap().len(), 2);
    assert_eq!(
        fixture.get("/api/history/query?lot=B").await.json(),
        serde_json::json!([])
    );
}

#[tokio::test]
async fn pages_follow_each_other_and_count_gives_their_sum() {
    let fixture = with_parts(20);
    let page = "/api/history/query?verdict=pass&limit=5&offset=10";
    let seqs: Vec<_> = fixture
        .get(page)
        .await
        .json()
        .as_array()
        .unwrap()
        .iter()
        .map(|it| it["seq"].as_u64().unwrap())
        .collect();
    assert_eq!(seqs, [13, 14, 16, 17, 18]);
    let count = fixture.get("/api/history/count?verdict=pass").await.json();
    assert_eq!(count, serde_json::json!({"parts": 16}));
    let beyond = "/api/history/query?offset=20";
    assert_eq!(fixture.get(beyond).await.json(), serde_json::json!([]));
}

#[tokio::test]
async fn the_yield_of_a_span_is_counted() {
    let fixture = with_parts(20);
    let day = "/api/history/yield?since=1970-01-01T00:00:05Z&until=1970-01-01T00:00:11Z";
    let counts = fixture.get(day).await.json();
    assert_eq!((&counts["parts"], &counts["fail"]), (&6.into(), &2.into()));
    let ever = fixture.get("/api/history/yield").await.json();
    assert_eq!(ever["parts"], 20);
}

#[tokio::test]
async fn a_histogram_counts_values_once_and_has_limits() {
    let fixture = with_parts(20);
    let path = "/api/history/histogram?param=operate_voltage_v&lot=A";
    let classes = fixture.get(path).await.json();
    let all: u64 = classes["counts"]
        .as_array()
        .unwrap()
        .iter()
        .map(|it| it.as_u64().unwrap())
        .sum();
    assert_eq!((all, &classes["high"]), (20, &9.0.into()));
    assert!(classes["low"].is_null());
}

#[tokio::test]
async fn control_limits_use_all_points_not_only_shown() {
    let fixture = with_parts(20);
    let path = "/api/history/spc?param=operate_voltage_v";
    let whole = fixture.get(path).await.json();
    assert_eq!(whole[0]["kind"], "individuals");
    let points = whole[0]["points"].as_array().unwrap();
    assert_eq!((points.len(), &whole[0]["first"]), (20, &0.into()));
    let last = fixture.get(&format!("{path}&last=3")).await.json();
    assert_eq!(last[0]["first"], 17);
    assert_eq!(last[0]["points"].as_array().unwrap(), &points[17..]);
    assert_eq!(last[0]["centre"], whole[0]["centre"]);
    let ranges = "/api/history/spc?param=operate_voltage_v&subgroup=5&rules=western-electric";
    assert_eq!(fixture.get(ranges).await.json()[1]["kind"], "ranges");
}

#[tokio::test]
async fn every_report_prints_in_both_languages_without_scripts() {
    let fixture = with_parts(20);
    for (route, en, zh) in [
        ("report/lot?lot=A", "Lot report", "批次检验报告"),
        (
            "report/certificate?lot=A&seq=7",
            "Not tested: insulation",
            "未测项目：绝缘",
        ),
        (
            "report/chart?param=operate_voltage_v",
            "Control charts",
            "控制图",
        ),
        ("report/alarms?lot=A", "Alarm list", "报警清单"),
    ] {
        let and = if route.contains('?') { '&' } else { '?' };
        let usual = format!("/api/history/{route}");
        let named = |lang| format!("/api/history/{route}{and}lang={lang}");
        let chinese = "zh-CN,zh;q=0.9,en;q=0.8";
        for (answer, word) in [
            (fixture.get(&usual).await, en),
            (fixture.get_in(chinese, &usual).await, zh),
            (fixture.get_in(chinese, &named("en")).await, en),
            (fixture.get(&named("zh")).await, zh),
        ] {
            assert_eq!(answer.status, 200, "{route}");
            assert_eq!(answer.headers["content-type"], "text/html; charset=utf-8");
            assert!(answer.text().contains(word), "{route}: {word}");
            let policy = answer.headers["content-security-policy"].to_str().unwrap();
            assert!(policy.starts_with("default-src 'none'") && !policy.contains("script"));
        }
    }
}

#[tokio::test]
async fn an_export_holds_the_rows_of_the_filter() {
    let fixture = with_parts(1000);
    let csv = fixture.get("/api/history/export.csv?verdict=fail").await;
    assert_eq!(csv.headers["content-type"], "text/csv; charset=utf-8");
    assert!(
        csv.headers["content-disposition"]
            .to_str()
            .unwrap()
            .ends_with(".csv\"")
    );
    let text = csv.text();
    assert!(text.starts_with("\u{feff}time,lot,run,kind,seq,"));
    assert_eq!(text.lines().count(), 201);
    let sheet = fixture
        .get("/api/history/export.xlsx?limit=3&lang=en")
        .await;
    assert!(sheet.body.starts_with(b"PK") && sheet.status == 200);
}

#[tokio::test]
async fn alarms_come_in_order_of_time_by_pages() {
    let fixture = with_parts(1);
    let mut store = Store::open(&fixture.db).unwrap();
    for at in [3, 1, 2] {
        let alarm = AlarmRecord {
            code: format!("alarm {at}"),
            raised_at_us: at,
            ..AlarmRecord::default()
        };
        store.record(&[Row::Alarm(alarm)]).unwrap();
    }
    let alarms = fixture.get("/api/history/alarms?limit=2&offset=1").await;
    let codes: Vec<_> = alarms
        .json()
        .as_array()
        .unwrap()
        .iter()
        .map(|it| it["code"].clone())
        .collect();
    assert_eq!(codes, ["alarm 2", "alarm 3"]);
}

#[tokio::test]
async fn an_answer_of_many_pieces_is_complete() {
    let fixture = with_parts(1000);
    let answer = fixture.get("/api/history/query").await;
    assert!(answer.body.len() > 200_000);
    let parts = answer.json();
    assert_eq!(parts.as_array().unwrap().len(), 1000);
    assert_eq!(parts[999]["seq"], 1000);
}

#[tokio::test]
async fn list_show_and_stats_agree_with_the_rows() {
    let fixture = with_parts(20);
    let lots = fixture.get("/api/history/list?lot=A").await.json();
    assert_eq!(
        (&lots[0]["parts"], &lots[0]["fail"]),
        (&20.into(), &4.into())
    );
    let shown = fixture.get("/api/history/show?lot=A&seq=7").await.json();
    assert_eq!(shown[0]["measurements"][0]["high"], 9.0);
    let stats = fixture
        .get("/api/history/stats?param=operate_voltage_v&lot=A")
        .await
        .json();
    assert_eq!((&stats["n"], &stats["max"]), (&20.into(), &7.2.into()));
    assert!(stats["cpk"].is_number() && stats["cp"].is_null());
}

#[tokio::test]
async fn a_malformed_filter_is_refused_with_the_member() {
    let fixture = with_parts(1);
    for (query, said) in [
        ("query?lto=A", "lto"),
        ("query?limit=-1", "limit"),
        ("query?limit=x", "limit"),
        ("query?since=soon", "RFC 3339"),
        ("query?verdict=good", "pass, fail, void, unjudged"),
        ("query?kind=x", "lot, golden, all"),
        ("query?min=1", "needs param"),
        ("query?param=operate_voltage_v&min=NaN", "finite"),
        ("query?param=operate_voltage_v&min=2&max=1", "above max"),
        ("query?param=nothing", KEY),
        ("list?verdict=pass", "lot, run, recipe"),
        ("count?limit=1", "unknown member"),
        ("count?param=nothing", KEY),
        ("yield?lot=A", "since, until"),
        ("alarms?verdict=fail", "verdict"),
        ("alarms?since=x", "RFC 3339"),
        ("stats", "param"),
        ("histogram", "param"),
        ("histogram?param=operate_voltage_v&min=1", "min"),
        ("spc?param=nothing", KEY),
        ("spc?param=operate_voltage_v&subgroup=11", "1 to 10"),
        ("spc?param=operate_voltage_v&rules=mine", "nelson"),
        ("spc?param=operate_voltage_v&last=0", "1 to 10000"),
        ("spc?param=operate_voltage_v&max=7", "max"),
        ("spc?lang=en", "lang"),
        ("spc?sigma=3", "sigma"),
        ("report/lot", "lot"),
        ("report/lot?lot=A&lang=fr", "en"),
        ("report/lot?lot=A&verdict=pass", "verdict"),
        ("report/lot?lot=A&ideal_cycle_s=0", "more than 0"),
        ("report/lot?lot=A&seq=1", "seq"),
        ("report/certificate?lot=A", "seq"),
        ("report/certificate?seq=1", "lot"),
        ("report/alarms?bin=pass", "bin"),
        ("report/alarms?seq=1", "seq"),
        ("report/chart?param=nothing", KEY),
        ("export.csv?verdict=good", "pass, fail, void, unjudged"),
        ("export.csv?param=nothing", KEY),
        ("export.xlsx?kind=x", "lot, golden, all"),
        ("export.xlsx?seq=1", "seq"),
        ("stats?param=nothing", KEY),
        ("stats?param=operate_voltage_v&max=1", "max"),
        ("show?lot=A", "seq"),
        ("show?lot=A&seq=1&kind=all", "lot, golden"),
        ("show?lot=A&seq=1&run=x", "run"),
    ] {
        let reason = fixture
            .get(&format!("/api/history/{query}"))
            .await
            .refused(400);
        assert!(reason.contains(said), "{query}: {reason}");
    }
}

#[tokio::test]
async fn an_unknown_lot_run_or_part_is_404() {
    let fixture = with_parts(1);
    let path = "/api/history/stats?param=operate_voltage_v&lot=B";
    assert!(fixture.get(path).await.refused(404).contains("no run"));
    let path = "/api/history/show?lot=A&seq=2";
    assert!(
        fixture
            .get(path)
            .await
            .refused(404)
            .contains("no lot part 2")
    );
    for path in [
        "show?lot=A&seq=1&run=2",
        "spc?param=operate_voltage_v&lot=B",
        "spc?param=operate_voltage_v",
        "histogram?param=operate_voltage_v&recipe=x",
        "report/lot?lot=B",
        "report/lot?lot=A&run=2",
        "report/certificate?lot=A&seq=2",
        "report/certificate?lot=A&seq=1&recipe=x",
        "report/chart?param=operate_voltage_v&lot=B",
        "report/alarms?lot=B",
        "export.csv?lot=B",
        "export.xlsx?lot=B",
    ] {
        fixture
            .get(&format!("/api/history/{path}"))
            .await
            .refused(404);
    }
    let path = "/api/history/show?lot=A'--&seq=18446744073709551615";
    fixture.get(path).await.refused(404);
}

#[tokio::test]
async fn without_a_history_file_reading_creates_none() {
    let fixture = Fixture::new();
    for route in [
        "query",
        "list",
        "show?lot=A&seq=1",
        "stats?param=operate_voltage_v",
        "count",
        "yield",
        "histogram?param=operate_voltage_v",
        "spc",
        "alarms",
        "report/lot?lot=A",
        "report/certificate?lot=A&seq=1",
        "report/chart",
        "report/alarms",
        "export.csv",
        "export.xlsx",
    ] {
        let reason = fixture
            .get(&format!("/api/history/{route}"))
            .await
            .refused(404);
        assert!(reason.contains("run a lot"), "{reason}");
    }
    assert!(!fixture.db.exists());
}

#[tokio::test]
async fn a_file_of_another_program_is_refused_unchanged() {
    let fixture = Fixture::new();
    std::fs::write(&fixture.db, "no database").unwrap();
    assert!(
        fixture
            .get("/api/history/list")
            .await
            .refused(500)
            .contains("not a relayrig history")
    );
    assert_eq!(std::fs::read(&fixture.db).unwrap(), b"no database");
}

#[tokio::test]
async fn the_audit_lists_orders_with_their_persons() {
    let fixture = with_parts(1);
    let mut store = Store::open(&fixture.db).unwrap();
    for (at_us, who, refused) in [
        (1, "li", None),
        (2, "wang", Some(Message::new("refusal", "between_lots"))),
    ] {
        let row = OrderRecord {
            at_us,
            who: who.into(),
            what: r#"{"order":"start","lot":"A"}"#.into(),
            refused,
            ..OrderRecord::default()
        };
        store.record(&[Row::Order(row)]).unwrap();
    }
    let all = fixture.get("/api/history/orders").await.json();
    assert_eq!(all.as_array().unwrap().len(), 2, "{all}");
    assert_eq!(all[0]["what"]["lot"], "A");
    let one = fixture
        .get("/api/history/orders?who=wang&limit=5")
        .await
        .json();
    assert_eq!(one.as_array().unwrap().len(), 1);
    assert_eq!(one[0]["refused_zh"], "设备正在切换批次；请重试");
    let why = fixture
        .get("/api/history/orders?verdict=pass")
        .await
        .refused(400);
    assert!(why.contains("verdict"), "{why}");
}

#[tokio::test]
async fn lots_compare_and_rejects_are_ranked() {
    let fixture = with_parts(20);
    let rejects = fixture.get("/api/history/rejects?lot=A").await.json();
    assert_eq!(
        (&rejects["rejects"], &rejects["parts"]),
        (&4.into(), &20.into())
    );
    let counts = fixture.get("/api/history/alarm-counts?since=today").await;
    assert_eq!(counts.json(), serde_json::json!([]));
    add_lot_b(&fixture, 10);
    let both = "param=operate_voltage_v&lots=%5B%22A%22,%22B%22%5D";
    let compared = fixture.get(&format!("/api/history/compare?{both}")).await;
    let compared = compared.json();
    assert_eq!(compared["lots"][1]["n"], 10);
    // F = t^2: the means differ by 0.05 V; the variances are those of 1 to 20 and of 1 to 10 hundredths of a volt.
    let f = 0.05_f64.powi(2) / (35e-4 / 20.0 + 55e-4 / 6.0 / 10.0);
    assert!((compared["means"]["f"].as_f64().unwrap() - f).abs() < 1e-6);
    let page = fixture
        .get(&format!("/api/history/report/comparison?{both}&lang=en"))
        .await;
    assert!(page.text().contains("Comparison of lots"));
    for (query, said) in [
        ("compare?param=operate_voltage_v&lots=A", "JSON array"),
        (
            "compare?param=operate_voltage_v&lots=%5B%22A%22%5D",
            "2 to 8",
        ),
        (
            "compare?param=operate_voltage_v&lots=%5B%22A%22,%22B%22,%22A%22%5D",
            "found \"A\" twice",
        ),
        ("rejects?verdict=fail", "verdict"),
    ] {
        let answer = fixture.get(&format!("/api/history/{query}")).await;
        let reason = answer.refused(400);
        assert!(reason.contains(said), "{query}: {reason}");
    }
}

#[tokio::test]
async fn a_refused_member_has_a_chinese_name() {
    let fixture = with_parts(1);
    for (query, name) in [
        ("query?verdict=good", "判定"),
        ("query?kind=odd", "类别"),
        ("query?param=colour", "项目"),
        ("query?min=1", "下限"),
        ("query?param=operate_voltage_v&max=NaN", "上限"),
        ("compare?param=operate_voltage_v&lots=A", "批次"),
        ("report/lot?lot=A&ideal_cycle_s=0", "最短节拍"),
        ("spc?param=operate_voltage_v&subgroup=11", "子组"),
    ] {
        let answer = fixture.get(&format!("/api/history/{query}")).await;
        answer.refused(400);
        let said = format!("查询条件“{name}”无效");
        assert_eq!(answer.json()["reason_zh"], said, "{query}");
        let member = answer.json()["args"]["member"].clone();
        assert!(
            query.contains(member.as_str().unwrap()),
            "{query}: {member}"
        );
    }
}
