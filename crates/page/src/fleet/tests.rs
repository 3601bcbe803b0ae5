//! Tests of the page of many rigs, with files in place of the database.

#![allow(clippy::unwrap_used)]

use super::*;
use crate::history::RigName;
use ::history::inquiry::rigs::{Now, Trouble};
use ::history::{Archive, HistoryError, LotRecord, Moment, PartRecord, Row, Store, snapshot_hash};
use axum::body::{Body, to_bytes};
use axum::http::{Request, StatusCode};
use std::path::PathBuf;
use tower::ServiceExt;

/// A folder with a file for each rig.
#[derive(Debug)]
struct Files(PathBuf);

impl Archives for Files {
    fn open(&self, rig: Option<&RigName>) -> ::history::Result<Archive> {
        match rig {
            Some(rig) => Archive::open(&self.0.join(format!("{}.{}.db", rig.site, rig.rig))),
            None => Err(HistoryError::Server("all rigs at once".into())),
        }
    }
}

/// Stores one part of lot A.
fn fill(file: &std::path::Path) {
    let mut store = Store::open(file).unwrap();
    let lot = LotRecord {
        lot: "A".to_owned(),
        recipe: "jzc-22f-012".to_owned(),
        recipe_hash: snapshot_hash(""),
        opened_at_us: 1,
        ..LotRecord::default()
    };
    store.begin_lot(&lot).unwrap();
    let part = PartRecord {
        lot: "A".to_owned(),
        seq: 1,
        kind: "lot".to_owned(),
        verdict: "pass".to_owned(),
        bin: "pass".to_owned(),
        judged_at_us: 2,
        ..PartRecord::default()
    };
    store.record(&[Row::Part(part)]).unwrap();
}

struct Fixture {
    router: Router,
    _folder: tempfile::TempDir,
}

impl Fixture {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        fill(&folder.path().join("suzhou.rig 7.db"));
        let seen = Overview {
            target: "postgres://db/relayrig".to_owned(),
            trouble: Some(Trouble {
                text: "postgres://db/relayrig: Connection refused".to_owned(),
                remedy: "network",
                since: Moment(3),
            }),
            now: Some(Now {
                at: Moment(2),
                rigs: Vec::new(),
            }),
            day: None,
        };
        let router = router(FleetShared {
            overview: watch::channel(seen).1,
            archives: Arc::new(Files(folder.path().to_owned())),
        });
        Self {
            router,
            _folder: folder,
        }
    }

    async fn get(&self, path: &str) -> (StatusCode, String) {
        let request = Request::get(path).body(Body::empty()).unwrap();
        let answer = self.router.clone().oneshot(request).await.unwrap();
        let status = answer.status();
        let body = to_bytes(answer.into_body(), 1 << 20).await.unwrap();
        (status, String::from_utf8(body.to_vec()).unwrap())
    }
}

#[tokio::test]
async fn a_path_chooses_the_rig_whose_history_answers() {
    let fixture = Fixture::new();
    let (status, count) = fixture
        .get("/rigs/suzhou/rig%207/api/history/count?lot=A")
        .await;
    assert_eq!((status, count.as_str()), (StatusCode::OK, r#"{"parts":1}"#));
    let (status, other) = fixture.get("/rigs/suzhou/rig%208/api/history/count").await;
    assert_eq!(status, StatusCode::NOT_FOUND, "{other}");
    let (status, all) = fixture.get("/api/history/count").await;
    assert_eq!(status, StatusCode::SERVICE_UNAVAILABLE, "{all}");
    let (status, unknown) = fixture
        .get("/rigs/suzhou/rig%207/api/history/count?site=x")
        .await;
    assert_eq!(status, StatusCode::BAD_REQUEST, "{unknown}");
}

#[tokio::test]
async fn a_lost_database_leaves_the_last_answer() {
    let (status, text) = Fixture::new().get("/api/fleet").await;
    let overview: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(status, StatusCode::OK);
    assert_eq!(overview["trouble"]["remedy"], "network");
    assert!(
        overview["now"]["rigs"].is_array() && overview["day"].is_null(),
        "{text}"
    );
}

#[tokio::test]
async fn all_rigs_and_one_rig_have_the_same_page() {
    let fixture = Fixture::new();
    let (status, page) = fixture.get("/").await;
    assert_eq!(status, StatusCode::OK);
    assert!(
        page.contains("data-page=\"rigs\"") && page.contains("/page/history-"),
        "{page}"
    );
    assert_eq!(fixture.get("/rigs/suzhou/rig%207/").await.1, page);
    let (_, document) = fixture.get("/api/openapi.json").await;
    let document: Value = serde_json::from_str(&document).unwrap();
    let of_part = &document["paths"]["/rigs/{site}/{rig}/api/history/show"]["get"];
    assert_eq!(
        of_part["parameters"].as_array().unwrap().len(),
        6,
        "{of_part}"
    );
}

#[tokio::test]
async fn nothing_on_the_page_changes_a_rig() {
    for route in routes() {
        let changes =
            route.method == crate::api::Method::Post && !route.path.ends_with("/quality/grr");
        assert!(!changes && route.role.is_none(), "{}", route.path);
    }
}
