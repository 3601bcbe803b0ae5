//! Tests of results from outside of the rig over HTTP.

use super::*;
use ::history::{LotRecord, PartRecord, Row, Store, snapshot_hash};
use serde_json::json;

const RECIPE: &str =
    "[external]\nr_iso_ohm = { low = 1e9 }\n[decision]\nrule = \"guard_band\"\nslow_repeats = 3\n";

/// Creates a server whose history has a lot that needs an isolation resistance.
fn fixture() -> Fixture {
    let fixture = Fixture::new();
    let mut store = Store::open(&fixture.db).unwrap();
    let lot = LotRecord {
        lot: "A".into(),
        recipe: "ssr".into(),
        recipe_hash: snapshot_hash(RECIPE),
        recipe_snapshot: RECIPE.into(),
        opened_at_us: 1,
        ..LotRecord::default()
    };
    store.begin_lot(&lot).unwrap();
    let part = PartRecord {
        lot: "A".into(),
        seq: 1,
        serial: Some("A-1".into()),
        verdict: "pass".into(),
        bin: "pass".into(),
        kind: "lot".into(),
        judged_at_us: 2,
        ..PartRecord::default()
    };
    store.record(&[Row::Part(part)]).unwrap();
    fixture
}

#[tokio::test]
async fn an_engineer_enters_a_result_that_all_read() {
    let fixture = fixture();
    let mut register = fixture.register();
    register.add("zhao", Role::Engineer, PASSWORD, 0).unwrap();
    let now_us = jiff::Timestamp::now().as_microsecond();
    let [zhao, li] = ["zhao", "li"].map(|who| register.open_session(who, now_us).unwrap());
    let path = "/api/lots/external";
    let typed = |value: f64| json!({"lot": "A", "serial": "A-1", "key": "r_iso_ohm", "value": value, "u": 1e8});
    fixture.post(path, None, typed(4e10)).await.refused(401);
    fixture
        .post(path, Some(&li), typed(4e10))
        .await
        .refused(403);
    for (change, status, said) in [
        (json!({"lot": "B"}), 404, "no lot \"B\""),
        (
            json!({"serial": "A-9"}),
            400,
            "serial: found \"A-9\", expected the serial number",
        ),
        (json!({"seq": 1}), 400, "seq: found"),
        (
            json!({"value": -1.0}),
            400,
            "value: found \"-1\", expected a number of ohm above 0",
        ),
        (
            json!({"key": "dwv_ua"}),
            400,
            "expected a key of [external] of ssr: \"r_iso_ohm\"",
        ),
        (json!({"key": "iso"}), 400, "r_iso_ohm"),
        (
            json!({"u": null}),
            400,
            "u: found nothing, expected an expanded uncertainty",
        ),
    ] {
        let mut body = typed(4e10);
        body.as_object_mut()
            .unwrap()
            .extend(change.as_object().unwrap().clone());
        let refused = fixture.post(path, Some(&zhao), body).await.refused(status);
        assert!(refused.contains(said), "{refused}");
    }
    let lots = fixture.get("/api/lots").await.json();
    assert_eq!(lots[0]["external"]["missing"][0], "r_iso_ohm");
    let bad = fixture.post(path, Some(&zhao), typed(5e8)).await.json();
    assert_eq!(
        (&bad["standing"]["acceptable"], &bad["standing"]["fail"]),
        (&json!(false), &json!(1))
    );
    let good = fixture.post(path, Some(&zhao), typed(4e10)).await.json();
    assert_eq!(good["standing"]["acceptable"], true);
    assert_eq!(
        fixture.get("/api/history/external?lot=A").await.json(),
        good
    );
    let [first, second] = [0, 1].map(|n| good["results"][n].clone());
    assert_eq!(
        (&first["superseded"], &second["superseded"]),
        (&json!(true), &json!(false))
    );
    assert_eq!(
        (&second["who"], &second["verdict"]),
        (&json!("zhao"), &json!("pass"))
    );
    let part = fixture.get("/api/history/show?lot=A&seq=1").await.json();
    assert_eq!(part[0]["external"].as_array().unwrap().len(), 2);
    // A body that cannot be read is no attempt.
    let orders = fixture
        .get("/api/history/orders?order=external_result")
        .await
        .json();
    let refused = orders
        .as_array()
        .unwrap()
        .iter()
        .filter(|it| !it["refused"].is_null());
    assert_eq!((orders.as_array().unwrap().len(), refused.count()), (9, 7));
    fixture
        .get("/api/history/external?lot=B")
        .await
        .refused(404);
}
