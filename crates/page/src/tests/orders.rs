//! Tests of orders: accepted, refused, and refused without effect.

use super::*;
use serde_json::json;

#[tokio::test]
async fn stop_works_and_may_be_repeated() {
    let fixture = Fixture::new();
    let first = fixture.order(r#"{"order":"stop"}"#).await;
    assert_eq!(first.status, 200);
    assert_eq!(first.json(), serde_json::json!({"order": "stop"}));
    assert!(fixture.stopped());
    assert_eq!(fixture.order(r#"{"order":"stop"}"#).await.status, 200);
}

#[tokio::test]
async fn a_refused_order_has_its_reason_in_both_languages() {
    let fixture = Fixture::new();
    for order in ["start", "hold", "unhold", "abort", "clear", "reset"] {
        let answer = fixture.order(format!(r#"{{"order":"{order}"}}"#)).await;
        assert_eq!(answer.refused(409), format!("{order}: the run has ended"));
        assert_eq!(answer.json()["reason_zh"], "本次运行已结束");
    }
    assert!(!fixture.stopped());
}

#[tokio::test]
async fn an_unknown_order_is_answered_with_the_known_ones() {
    let fixture = Fixture::new();
    for order in ["STOP", "", "stop ", "halt"] {
        let answer = fixture.order(format!(r#"{{"order":"{order}"}}"#)).await;
        assert!(
            answer.refused(400).contains("expected"),
            "{}",
            answer.text()
        );
    }
    let stpo = fixture.order(r#"{"order":"stpo"}"#).await.refused(400);
    assert_eq!(stpo, "order: found \"stpo\", expected \"stop\"?");
    assert!(!fixture.stopped());
}

#[tokio::test]
async fn a_mistyped_member_never_acts_on_another_lot() {
    let fixture = Fixture::new();
    for (body, reason) in [
        (
            json!({"order": "start", "lto": "B"}),
            "lto: found an unknown member, expected \"lot\"?",
        ),
        (
            json!({"order": "close_lot", "lots": "B"}),
            "lots: found an unknown member, expected \"lot\"?",
        ),
        (
            json!({"order": "stop", "lot": "B"}),
            "lot: found an unknown member, expected none",
        ),
        (
            json!({"order": "hold_lot", "reason": "label"}),
            "lot: found nothing, expected a value",
        ),
        (
            json!({"order": "mode", "mode": "manul"}),
            "mode: found \"manul\", expected \"manual\"?",
        ),
    ] {
        let answer = fixture.order(body.to_string()).await;
        assert_eq!(answer.refused(400), reason);
    }
    let twice = fixture
        .order(r#"{"order":"close_lot","lot":"A","lot":"B"}"#)
        .await;
    assert_eq!(twice.refused(400), "lot: found twice, expected once");
    assert!(!fixture.stopped());
}

#[tokio::test]
async fn forbidden_orders_reach_the_audit() {
    let fixture = Fixture::new();
    let too_weak = fixture
        .order(r#"{"order":"shelve","alarm":"door_open","reason":"x"}"#)
        .await;
    too_weak.refused(403);
    let in_chinese = &too_weak.json()["reason_zh"];
    assert_eq!(in_chinese, "此操作需要维修员权限，您的角色是操作员");
    fixture.order(r#"{"order":"stop"}"#).await;
    let denied = fixture.denied.lock().unwrap().clone();
    assert_eq!(denied.len(), 1, "{denied:?}");
    assert!(denied[0].starts_with("operator li shelve: "), "{denied:?}");
}

#[tokio::test]
async fn a_full_queue_is_not_an_ended_controller() {
    let fixture = Fixture::new();
    let waiting = fixture.orders.reserve_many(WAITING).await.unwrap();
    let full = fixture.order(r#"{"order":"stop"}"#).await.refused(409);
    assert!(full.starts_with("stop: 16 orders wait"), "{full}");
    drop(waiting);
    fixture.controller.abort();
    fixture.orders.closed().await;
    let ended = fixture.order(r#"{"order":"stop"}"#).await.refused(409);
    assert!(
        ended.starts_with("stop: the controller has ended"),
        "{ended}"
    );
}

#[tokio::test]
async fn a_malformed_order_is_refused() {
    let fixture = Fixture::new();
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
        fixture.order(body).await.refused(400);
    }
    let plain = Request::post("/api/orders").header("content-type", "text/plain");
    let plain = plain.header("authorization", fixture.bearer());
    let answer = fixture
        .ask(plain.body(r#"{"order":"stop"}"#.into()).unwrap())
        .await;
    answer.refused(415);
    assert!(!fixture.stopped());
}

#[tokio::test]
async fn a_body_of_more_than_16_kb_is_refused() {
    let fixture = Fixture::new();
    let body = |length: usize| format!("{:<length$}", r#"{"order":"stop"}"#);
    fixture
        .order(body(asked::BODY_LIMIT + 1))
        .await
        .refused(413);
    assert!(!fixture.stopped());
    assert_eq!(fixture.order(body(asked::BODY_LIMIT)).await.status, 200);
}

#[tokio::test]
async fn a_foreign_page_cannot_stop_the_line() {
    let fixture = Fixture::new();
    let request = |origin: &str| {
        Request::post("/api/orders")
            .header("content-type", "application/json")
            .header("authorization", fixture.bearer())
            .header("host", "127.0.0.1:8080")
            .header("origin", origin)
            .body(Body::from(r#"{"order":"stop"}"#))
            .unwrap()
    };
    let answer = fixture.ask(request("http://evil.example")).await;
    assert!(answer.refused(403).contains("Origin: http://evil.example"));
    assert!(!fixture.stopped());
    assert_eq!(
        fixture.ask(request("http://127.0.0.1:8080")).await.status,
        200
    );
    assert!(fixture.stopped());
}

#[tokio::test]
async fn without_a_controller_orders_are_refused_with_reason() {
    let mut fixture = Fixture::new();
    fixture.end_of_the_controller().await;
    assert!(
        fixture
            .order(r#"{"order":"stop"}"#)
            .await
            .refused(409)
            .contains("has ended")
    );
}
