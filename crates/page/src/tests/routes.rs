//! Tests of the page and its scripts, the view, the figures, and the answers to wrong paths.

use super::*;

#[tokio::test]
async fn the_policy_allows_scripts_of_the_rig_only() {
    let answer = Fixture::new().get("/").await;
    assert_eq!(answer.status, 200);
    assert_eq!(answer.headers["content-type"], "text/html; charset=utf-8");
    let policy = answer.headers["content-security-policy"].to_str().unwrap();
    assert!(policy.starts_with("default-src 'none'"));
    assert!(policy.contains("script-src 'self' 'sha256-"));
    assert!(!policy.contains("unsafe"));
    assert_eq!(answer.headers["x-frame-options"], "DENY");
}

/// Returns the answer for `path` and its unpacked body; `accepts` is the header `Accept-Encoding` of the client.
async fn unpacked(fixture: &Fixture, path: &str, accepts: &str) -> (Answer, String) {
    let request = Request::get(path).header("accept-encoding", accepts);
    let answer = fixture.ask(request.body(Body::empty()).unwrap()).await;
    assert_eq!(answer.headers["vary"], "accept-encoding");
    let text = if answer.headers.contains_key("content-encoding") {
        assert_eq!(answer.headers["content-encoding"], "gzip");
        std::io::read_to_string(flate2::read::GzDecoder::new(&answer.body[..])).unwrap()
    } else {
        answer.text().to_owned()
    };
    (answer, text)
}

#[tokio::test]
async fn only_a_client_that_accepts_gzip_gets_it() {
    let fixture = Fixture::new();
    let (_, page) = unpacked(&fixture, "/", "").await;
    for (accepts, packed) in [
        ("gzip", true),
        ("br, GZIP ; q=0.5", true),
        ("deflate,gzip;q=1.0,*;q=0.5", true),
        ("identity", false),
        ("gzip;q=0", false),
        ("gzip;q=often", false),
    ] {
        let (answer, text) = unpacked(&fixture, "/", accepts).await;
        assert_eq!(
            answer.headers.contains_key("content-encoding"),
            packed,
            "{accepts}"
        );
        assert_eq!(text, page);
    }
}

#[tokio::test]
async fn a_browser_keeps_a_script_under_its_versioned_name() {
    let fixture = Fixture::new();
    let (_, page) = unpacked(&fixture, "/", "gzip").await;
    let paths = page
        .split("<script type=\"application/json\" id=\"scripts\">")
        .nth(1);
    let paths = paths.unwrap().split("</script>").next().unwrap();
    let paths: std::collections::BTreeMap<String, String> = serde_json::from_str(paths).unwrap();
    assert_eq!(paths.len(), 13);
    for path in paths.values() {
        let (answer, text) = unpacked(&fixture, path, "gzip").await;
        assert!(text.starts_with(&format!("addPages(\"{path}\"")), "{path}");
        assert_eq!(
            answer.headers["content-type"],
            "text/javascript; charset=utf-8"
        );
        assert_eq!(answer.headers["x-content-type-options"], "nosniff");
        assert!(
            answer.headers["cache-control"]
                .to_str()
                .unwrap()
                .contains("immutable")
        );
        fixture.get(&path.replace(".js", "0.js")).await.refused(404);
    }
}

#[tokio::test]
async fn the_view_is_the_latest_one() {
    let fixture = Fixture::new();
    assert_eq!(fixture.get("/api/view").await.json()["judged"], 3);
    fixture.view.send_modify(|view| view.judged = 4);
    let answer = fixture.get("/api/view").await;
    assert_eq!(answer.json()["judged"], 4);
    assert_eq!(answer.json()["simulated"], true);
    assert_eq!(answer.headers["cache-control"], "no-store");
}

#[tokio::test]
async fn figures_follow_the_view_and_show_a_lost_controller() {
    let mut fixture = Fixture::new();
    let answer = fixture.get("/metrics").await;
    assert!(
        answer.headers["content-type"]
            .to_str()
            .unwrap()
            .starts_with("text/plain; version=0.0.4")
    );
    assert!(
        answer
            .text()
            .contains("relayrig_lot_verdicts{verdict=\"pass\"} 2\n")
    );
    assert!(answer.text().contains("relayrig_up 1\n"));
    fixture.end_of_the_controller().await;
    assert!(
        fixture
            .get("/metrics")
            .await
            .text()
            .contains("relayrig_up 0\n")
    );
}

#[tokio::test]
async fn an_unknown_path_gets_a_reason() {
    let fixture = Fixture::new();
    for path in [
        "/nothing",
        "/api",
        "/api/history",
        "/api/history/drop",
        "/..%2f..%2fetc/passwd",
        "//",
    ] {
        assert!(
            fixture.get(path).await.refused(404).contains("nothing at"),
            "{path}"
        );
    }
}

#[tokio::test]
async fn a_wrong_method_is_refused_with_the_right_one() {
    let fixture = Fixture::new();
    let answer = fixture.get("/api/orders").await;
    assert_eq!(answer.refused(405), "/api/orders does not take GET");
    assert_eq!(answer.headers["allow"], "POST");
    for path in [
        "/",
        "/api/view",
        "/api/events",
        "/metrics",
        "/api/history/list",
    ] {
        let request = Request::delete(path).body(Body::empty()).unwrap();
        fixture.ask(request).await.refused(405);
    }
}

#[tokio::test]
async fn trace_returns_the_requested_number_of_messages() {
    let fixture = Fixture::new();
    let count = |answer: Answer| answer.json()[0]["entries"].as_array().unwrap().len();
    assert_eq!(count(fixture.get("/api/trace").await), 100);
    assert_eq!(count(fixture.get("/api/trace?last=7").await), 7);
    for (query, reason) in [
        ("last=0", "expected 1 to 1000"),
        ("last=1001", "expected 1 to 1000"),
        ("last=all", "expected a whole number"),
        ("first=1", "unknown member"),
    ] {
        let answer = fixture.get(&format!("/api/trace?{query}")).await;
        assert!(answer.refused(400).contains(reason), "{query}");
    }
}
