//! Tests of every route of the list: documented, open to the right roles, closed to malformed requests.

use super::*;
use crate::api::{self, Method};

/// Returns no token, then a token of each role, weakest first.
pub(super) fn askers(fixture: &Fixture) -> [Option<String>; 4] {
    let [operator, maintainer, engineer] = Role::ALL.map(|role| Some(fixture.session(role)));
    [None, operator, maintainer, engineer]
}

pub(super) fn request(method: &str, path: &str, token: Option<&str>, body: &str) -> Request<Body> {
    let mut request = Request::builder().method(method).uri(path);
    if let Some(token) = token {
        request = request.header("authorization", format!("Bearer {token}"));
    }
    let request = request.header("content-type", "application/json");
    request.body(Body::from(body.to_owned())).unwrap()
}

fn paths(method: Method) -> Vec<String> {
    let routes = api::routes().into_iter();
    routes
        .filter(|it| it.method == method)
        .map(|it| it.path.into_owned())
        .collect()
}

#[tokio::test]
async fn reading_is_open_to_all_or_to_a_role() {
    let fixture = Fixture::new();
    let askers = askers(&fixture);
    for route in api::routes() {
        let path = route.path;
        // The event stream has no end.
        if route.method == Method::Post || path == "/api/events" {
            continue;
        }
        let mut answers = Vec::new();
        for (token, role) in askers
            .iter()
            .zip([None].into_iter().chain(Role::ALL.map(Some)))
        {
            let asked = request("GET", &path, token.as_deref(), "");
            let status = fixture.ask(asked).await.status.as_u16();
            match (route.role, role) {
                (Some(_), None) => assert_eq!(status, 401, "{path}"),
                (Some(needed), Some(role)) if role < needed => assert_eq!(status, 403, "{path}"),
                _ => answers.push(status),
            }
        }
        let refused = answers.iter().any(|it| [401, 403, 405, 500].contains(it));
        assert!(!refused, "{path}: {answers:?}");
        answers.dedup();
        assert_eq!(answers.len(), 1, "{path}: {answers:?}");
    }
}

#[tokio::test]
async fn an_order_needs_a_role_or_a_stronger_one() {
    let fixture = Fixture::new();
    let askers = askers(&fixture);
    // Statuses without login, for an operator, a maintainer, an engineer.
    for (order, expected) in [
        (r#"{"order":"stop"}"#, [401, 200, 200, 200]),
        (r#"{"order":"start"}"#, [401, 409, 409, 409]),
        (
            r#"{"order":"jog","motion":"probes_up"}"#,
            [401, 403, 200, 200],
        ),
        (r#"{"order":"mode","mode":"manual"}"#, [401, 403, 200, 200]),
        (
            r#"{"order":"start","lot":"A","recipe":"jzc-22f-012","count":5}"#,
            [401, 409, 409, 409],
        ),
        (
            r#"{"order":"hold_lot","lot":"A","reason":"label"}"#,
            [401, 200, 200, 200],
        ),
        (r#"{"order":"close_lot","lot":"A"}"#, [401, 200, 200, 200]),
        (r#"{"order":"release_lot","lot":"A"}"#, [401, 403, 200, 200]),
        (
            r#"{"order":"reopen_lot","lot":"A","reason":"late parts"}"#,
            [401, 403, 403, 200],
        ),
        (
            r#"{"order":"replaced","counter":"probe_touches"}"#,
            [401, 403, 200, 200],
        ),
        (r#"{"order":"start","lot":7}"#, [401, 400, 400, 400]),
        (
            r#"{"order":"start","lot":"A","count":-1}"#,
            [401, 400, 400, 400],
        ),
        (
            r#"{"order":"start","lot":"A","count":1.5}"#,
            [401, 400, 400, 400],
        ),
        (r#"{"order":"fly"}"#, [401, 400, 400, 400]),
    ] {
        for (token, expected) in askers.iter().zip(expected) {
            let asked = request("POST", "/api/orders", token.as_deref(), order);
            assert_eq!(fixture.ask(asked).await.status, expected, "{order}");
        }
    }
}

#[tokio::test]
async fn every_route_has_one_method() {
    let fixture = Fixture::new();
    for (path, allowed) in (paths(Method::Get).into_iter().map(|it| (it, "GET,HEAD")))
        .chain(paths(Method::Post).into_iter().map(|it| (it, "POST")))
    {
        for method in ["PUT", "DELETE", "PATCH", "OPTIONS"] {
            let answer = fixture.ask(request(method, &path, None, "")).await;
            assert!(answer.refused(405).contains(method), "{path}");
            assert_eq!(answer.headers["allow"], allowed, "{path}");
        }
    }
}

#[tokio::test]
async fn a_large_or_malformed_body_is_refused_without_effect() {
    let fixture = Fixture::new();
    let operator = fixture.token.clone();
    let large = format!("{{\"order\":\"{}\"}}", "x".repeat(asked::BODY_LIMIT));
    for path in ["/api/login", "/api/orders"] {
        for (body, status) in [
            (large.as_str(), 413),
            ("{\"order\":", 400),
            ("[]", 400),
            ("{}", 400),
            ("\u{0}", 400),
            (r#"{"order":7,"user":7,"password":7}"#, 400),
        ] {
            let asked = request("POST", path, Some(&operator), body);
            assert!(
                !fixture.ask(asked).await.refused(status).is_empty(),
                "{path}"
            );
        }
    }
    assert!(!fixture.stopped());
}

#[tokio::test]
async fn a_text_with_a_nul_is_refused() {
    let fixture = Fixture::new();
    let body = r#"{"user":"li\u0000","password":"x"}"#;
    let answer = fixture.ask(request("POST", "/api/login", None, body)).await;
    assert!(answer.refused(400).contains("U+0000"));
}

#[tokio::test]
async fn an_expired_or_ended_session_orders_nothing() {
    let fixture = Fixture::new();
    let long_ago_us = jiff::Timestamp::now().as_microsecond() - 13 * 3_600_000_000;
    let old = fixture.register().open_session("li", long_ago_us).unwrap();
    let ended = fixture.token.clone();
    let out = request("POST", "/api/logout", Some(&ended), "{}");
    assert_eq!(fixture.ask(out).await.status, 200);
    for token in [old.as_str(), &ended, "", "0123", &"f".repeat(64)] {
        let asked = request("POST", "/api/orders", Some(token), r#"{"order":"stop"}"#);
        assert!(fixture.ask(asked).await.refused(401).contains("log in"));
    }
    assert!(!fixture.stopped());
}

#[tokio::test]
async fn a_path_out_of_the_tree_is_404() {
    let fixture = Fixture::new();
    for path in [
        "/../etc/passwd",
        "/api/../../etc/passwd",
        "/%2e%2e/%2e%2e/etc/passwd",
        "/api/history/..%2f..%2fhistory-access.db",
        "/api/history/report/%00",
        "/api/orders/",
        "/api//orders",
        "/API/VIEW",
        "/api/view;x=1",
    ] {
        assert!(!fixture.get(path).await.refused(404).is_empty(), "{path}");
    }
}
