//! Orders: what is taken, what is refused, and that a refusal moves nothing.

use super::*;

#[tokio::test]
async fn stop_stops_and_may_be_said_twice() {
    let bench = Bench::new();
    let first = bench.order(r#"{"order":"stop"}"#).await;
    assert_eq!(first.status, 200);
    assert_eq!(first.json(), serde_json::json!({"order": "stop"}));
    assert!(bench.stopped());
    assert_eq!(
        bench.order(r#"{"order":"stop","why":"x"}"#).await.status,
        200
    );
}

#[tokio::test]
async fn a_known_order_that_is_not_taken_says_why_in_both_languages() {
    let bench = Bench::new();
    for order in ["start", "hold", "unhold", "abort", "clear", "reset"] {
        let answer = bench.order(format!(r#"{{"order":"{order}"}}"#)).await;
        assert_eq!(answer.refused(409), format!("{order}: the run has ended"));
        assert_eq!(answer.json()["reason_zh"], "本次运行已结束");
    }
    assert!(!bench.stopped());
}

#[tokio::test]
async fn an_unknown_order_is_answered_with_the_known_ones() {
    let bench = Bench::new();
    for order in ["STOP", "", "stop ", "halt"] {
        let answer = bench.order(format!(r#"{{"order":"{order}"}}"#)).await;
        assert!(answer.refused(400).contains("known are reset, start"));
    }
    assert!(!bench.stopped());
}

#[tokio::test]
async fn what_a_person_may_not_order_and_what_is_no_order_go_to_the_audit_with_the_name() {
    let bench = Bench::new();
    let too_weak = bench
        .order(r#"{"order":"shelve","alarm":"door_open","reason":"x"}"#)
        .await;
    too_weak.refused(403);
    let in_chinese = &too_weak.json()["reason_zh"];
    assert_eq!(in_chinese, "此操作需要维修员权限，您的角色是操作员");
    bench.order(r#"{"order":"halt"}"#).await.refused(400);
    bench.order(r#"{"order":"stop"}"#).await;
    let denied = bench.denied.lock().unwrap().clone();
    assert_eq!(denied.len(), 2, "{denied:?}");
    assert!(denied[0].starts_with("operator li shelve: "), "{denied:?}");
    assert!(denied[1].starts_with("operator li halt: "), "{denied:?}");
}

#[tokio::test]
async fn a_body_that_is_no_order_is_refused() {
    let bench = Bench::new();
    for body in [
        "",
        "stop",
        "{",
        "[]",
        "{}",
        r#"{"order":1}"#,
        r#"{"order":null}"#,
        "\u{0}",
    ] {
        bench.order(body).await.refused(400);
    }
    let plain = Request::post("/api/orders").header("content-type", "text/plain");
    let plain = plain.header("authorization", bench.bearer());
    let answer = bench
        .ask(plain.body(r#"{"order":"stop"}"#.into()).unwrap())
        .await;
    answer.refused(415);
    assert!(!bench.stopped());
}

#[tokio::test]
async fn a_body_of_more_than_16_kb_is_refused() {
    let bench = Bench::new();
    let body = |length: usize| format!("{:<length$}", r#"{"order":"stop"}"#);
    bench.order(body(router::BODY_LIMIT + 1)).await.refused(413);
    assert!(!bench.stopped());
    assert_eq!(bench.order(body(router::BODY_LIMIT)).await.status, 200);
}

#[tokio::test]
async fn a_foreign_page_cannot_stop_the_line() {
    let bench = Bench::new();
    let request = |origin: &str| {
        Request::post("/api/orders")
            .header("content-type", "application/json")
            .header("authorization", bench.bearer())
            .header("host", "127.0.0.1:8080")
            .header("origin", origin)
            .body(Body::from(r#"{"order":"stop"}"#))
            .unwrap()
    };
    let answer = bench.ask(request("http://evil.example")).await;
    assert!(answer.refused(403).contains("Origin: http://evil.example"));
    assert!(!bench.stopped());
    assert_eq!(
        bench.ask(request("http://127.0.0.1:8080")).await.status,
        200
    );
    assert!(bench.stopped());
}

#[tokio::test]
async fn after_the_controller_ended_a_stop_is_told_so() {
    let mut bench = Bench::new();
    bench.end_of_the_controller().await;
    assert!(
        bench
            .order(r#"{"order":"stop"}"#)
            .await
            .refused(409)
            .contains("has ended")
    );
}
