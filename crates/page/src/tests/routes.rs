//! The page, the view, the figures, and what is said where there is nothing.

use super::*;

#[tokio::test]
async fn the_page_is_html_that_may_run_its_own_script_only() {
    let answer = Bench::new().get("/").await;
    assert_eq!(answer.status, 200);
    assert_eq!(answer.headers["content-type"], "text/html; charset=utf-8");
    let policy = answer.headers["content-security-policy"].to_str().unwrap();
    assert!(policy.starts_with("default-src 'none'"));
    assert!(policy.contains("script-src 'self' 'sha256-"));
    assert!(!policy.contains("unsafe"));
    assert_eq!(answer.headers["x-frame-options"], "DENY");
}

/// Body of `path` for a client with this header, unpacked.
async fn unpacked(bench: &Bench, path: &str, accepts: &str) -> (Answer, String) {
    let request = Request::get(path).header("accept-encoding", accepts);
    let answer = bench.ask(request.body(Body::empty()).unwrap()).await;
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
    let bench = Bench::new();
    let (_, page) = unpacked(&bench, "/", "").await;
    for (accepts, packed) in [
        ("gzip", true),
        ("br, GZIP ; q=0.5", true),
        ("deflate,gzip;q=1.0,*;q=0.5", true),
        ("identity", false),
        ("gzip;q=0", false),
        ("gzip;q=often", false),
    ] {
        let (answer, text) = unpacked(&bench, "/", accepts).await;
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
    let bench = Bench::new();
    let (_, page) = unpacked(&bench, "/", "gzip").await;
    let paths = page
        .split("<script type=\"application/json\" id=\"scripts\">")
        .nth(1);
    let paths = paths.unwrap().split("</script>").next().unwrap();
    let paths: std::collections::BTreeMap<String, String> = serde_json::from_str(paths).unwrap();
    assert_eq!(paths.len(), 11);
    for path in paths.values() {
        let (answer, text) = unpacked(&bench, path, "gzip").await;
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
        bench.get(&path.replace(".js", "0.js")).await.refused(404);
    }
}

#[tokio::test]
async fn the_view_is_the_latest_one() {
    let bench = Bench::new();
    assert_eq!(bench.get("/api/view").await.json()["judged"], 3);
    bench.view.send_modify(|view| view.judged = 4);
    let answer = bench.get("/api/view").await;
    assert_eq!(answer.json()["judged"], 4);
    assert_eq!(answer.json()["simulated"], true);
    assert_eq!(answer.headers["cache-control"], "no-store");
}

#[tokio::test]
async fn the_figures_follow_the_view_and_say_when_the_controller_is_gone() {
    let mut bench = Bench::new();
    let answer = bench.get("/metrics").await;
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
    bench.end_of_the_controller().await;
    assert!(
        bench
            .get("/metrics")
            .await
            .text()
            .contains("relayrig_up 0\n")
    );
}

#[tokio::test]
async fn where_nothing_is_a_reason_is() {
    let bench = Bench::new();
    for path in [
        "/nothing",
        "/api",
        "/api/history",
        "/api/history/drop",
        "/..%2f..%2fetc/passwd",
        "//",
    ] {
        assert!(
            bench.get(path).await.refused(404).contains("nothing at"),
            "{path}"
        );
    }
}

#[tokio::test]
async fn a_wrong_method_is_named_and_the_right_one_is_told() {
    let bench = Bench::new();
    let answer = bench.get("/api/orders").await;
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
        bench.ask(request).await.refused(405);
    }
}

#[tokio::test]
async fn the_last_traffic_is_given_in_the_number_asked_for() {
    let bench = Bench::new();
    let count = |answer: Answer| answer.json()[0]["entries"].as_array().unwrap().len();
    assert_eq!(count(bench.get("/api/trace").await), 100);
    assert_eq!(count(bench.get("/api/trace?last=7").await), 7);
    for (query, reason) in [
        ("last=0", "expected 1 to 1000"),
        ("last=1001", "expected 1 to 1000"),
        ("last=all", "invalid"),
        ("first=1", "unknown field"),
    ] {
        let answer = bench.get(&format!("/api/trace?{query}")).await;
        assert!(answer.refused(400).contains(reason), "{query}");
    }
}
