//! Tests of the list of lots and the wear counters over HTTP.

use super::*;
use ::history::{
    Decision, HoldReason, LotRecord, LotState, LotStateRecord, Row, Store, WearRecord,
};

fn with_lots(states: &[(&str, LotState)]) -> Fixture {
    let fixture = Fixture::new();
    let mut store = Store::open(&fixture.db).unwrap();
    for (n, (lot, state)) in states.iter().enumerate() {
        let at_us = i64::try_from(n).unwrap() * 1_000_000;
        store
            .begin_lot(&LotRecord {
                lot: (*lot).into(),
                recipe: "jzc-22f-012".into(),
                opened_at_us: at_us,
                simulated: true,
                ..LotRecord::default()
            })
            .unwrap();
        let why = (*state == LotState::Held).then(|| HoldReason::Person("wrong label (li)".into()));
        let row = LotStateRecord {
            lot: (*lot).into(),
            state: *state,
            why,
            at_us,
        };
        store.record(&[Row::LotState(row)]).unwrap();
    }
    fixture
}

#[tokio::test]
async fn every_lot_has_its_allowed_orders_and_reasons() {
    let fixture = with_lots(&[
        ("A", LotState::Complete),
        ("B", LotState::Held),
        ("C", LotState::Open),
    ]);
    let lots = fixture.get("/api/lots").await.json();
    let answer: Vec<_> = lots.as_array().unwrap().iter().collect();
    let names: Vec<_> = answer
        .iter()
        .map(|it| it["lot"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["C", "B", "A"], "the last one first");
    assert_eq!(answer[1]["why"], "wrong label (li)");
    let live = |lot: &serde_json::Value| {
        let why_not = lot["why_not"].as_object().unwrap();
        assert_eq!(why_not.len(), Decision::ALL.len() + 1);
        let live = why_not.iter().filter(|(_, why)| why.is_null());
        live.map(|(order, _)| order.clone()).collect::<Vec<_>>()
    };
    assert_eq!(live(answer[0]), ["close_lot", "hold_lot", "start"]);
    assert_eq!(live(answer[1]), ["close_lot", "release_lot"]);
    assert_eq!(live(answer[2]), ["hold_lot", "reopen_lot", "start"]);
    let why = &answer[1]["why_not"]["start"];
    assert!(
        why["en"]
            .as_str()
            .unwrap()
            .contains("release the lot first")
    );
    assert!(why["zh"].as_str().unwrap().contains("放行"));
}

#[tokio::test]
async fn lots_come_by_pages() {
    let all = ["A", "B", "C", "D", "E"].map(|lot| (lot, LotState::Open));
    let fixture = with_lots(&all);
    let page = fixture.get("/api/lots?limit=2&offset=1").await.json();
    assert_eq!(
        (&page[0]["lot"], &page[1]["lot"]),
        (&"D".into(), &"C".into())
    );
    for limit in ["0", "201", "-1", "many"] {
        let path = format!("/api/lots?limit={limit}");
        assert!(!fixture.get(&path).await.refused(400).is_empty());
    }
}

#[tokio::test]
async fn wear_counters_are_those_of_the_rig_in_view() {
    let fixture = with_lots(&[("A", LotState::Open)]);
    let mut store = Store::open(&fixture.db).unwrap();
    for (simulated, more) in [(true, 7), (false, 9)] {
        let row = WearRecord {
            simulated,
            name: "probe_touches".into(),
            more,
        };
        store.record(&[Row::Wear(row)]).unwrap();
    }
    let wear = fixture.get("/api/wear").await.json();
    assert_eq!(wear[0]["count"], 7, "{wear}");
}
