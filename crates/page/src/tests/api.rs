//! Every route of the list, whoever asks and however: the document names it, and nothing but its own form is taken.

use super::*;
use crate::api::{self, Method};

/// Somebody of each role, and a stranger.
fn askers(bench: &Bench) -> [Option<String>; 4] {
    let now_us = jiff::Timestamp::now().as_microsecond();
    let mut register = Register::open(&bench.db.with_file_name("people.db")).unwrap();
    register.add("zhao", Role::Engineer, PASSWORD, 0).unwrap();
    let mut token = |name: &str| {
        let session = register.log_in(name, PASSWORD, now_us).unwrap();
        Some(session.unwrap().1)
    };
    [None, token("li"), token("wang"), token("zhao")]
}

fn request(method: &str, path: &str, token: Option<&str>, body: &str) -> Request<Body> {
    let mut request = Request::builder().method(method).uri(path);
    if let Some(token) = token {
        request = request.header("authorization", format!("Bearer {token}"));
    }
    let request = request.header("content-type", "application/json");
    request.body(Body::from(body.to_owned())).unwrap()
}

fn paths(method: Method) -> Vec<&'static str> {
    let offers = api::offers().into_iter();
    offers
        .filter(|it| it.method == method)
        .map(|it| it.path)
        .collect()
}

#[tokio::test]
async fn the_document_names_every_route_with_its_members_and_its_refusals() {
    let answer = Bench::new().get("/api/openapi.json").await;
    let document = answer.json();
    assert!(document["openapi"].as_str().unwrap().starts_with("3."));
    let offers = api::offers();
    assert_eq!(document["paths"].as_object().unwrap().len(), offers.len());
    for offer in offers {
        let (word, members) = match offer.method {
            Method::Get => ("get", "parameters"),
            Method::Post => ("post", "requestBody"),
        };
        let said = &document["paths"][offer.path][word];
        assert!(
            !said["summary"].as_str().unwrap().is_empty(),
            "{}",
            offer.path
        );
        let refusals = said["responses"].as_object().unwrap();
        assert!(refusals.contains_key("200") && refusals.contains_key("400"));
        let members = said[members].to_string();
        for member in &offer.members {
            let quoted = format!("\"{}\"", member.name);
            assert!(members.contains(&quoted), "{} {quoted}", offer.path);
        }
    }
}

#[tokio::test]
async fn whoever_looks_gets_the_same_answer_in_every_role() {
    let bench = Bench::new();
    let askers = askers(&bench);
    for path in paths(Method::Get) {
        // Its stream has no end.
        if path == "/api/events" {
            continue;
        }
        let mut answers = Vec::new();
        for token in &askers {
            let answer = bench.ask(request("GET", path, token.as_deref(), "")).await;
            assert!(
                ![401, 403, 405, 500].contains(&answer.status.as_u16()),
                "{path}"
            );
            answers.push(answer.status);
        }
        answers.dedup();
        assert_eq!(answers.len(), 1, "{path}: {answers:?}");
    }
}

#[tokio::test]
async fn an_order_takes_a_role_and_each_role_may_what_the_weaker_ones_may() {
    let bench = Bench::new();
    let askers = askers(&bench);
    // A stranger, operator, maintainer, engineer.
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
            assert_eq!(bench.ask(asked).await.status, expected, "{order}");
        }
    }
}

#[tokio::test]
async fn every_route_has_one_method() {
    let bench = Bench::new();
    for (path, allowed) in (paths(Method::Get).into_iter().map(|it| (it, "GET,HEAD")))
        .chain(paths(Method::Post).into_iter().map(|it| (it, "POST")))
    {
        for method in ["PUT", "DELETE", "PATCH", "OPTIONS"] {
            let answer = bench.ask(request(method, path, None, "")).await;
            assert!(answer.refused(405).contains(method), "{path}");
            assert_eq!(answer.headers["allow"], allowed, "{path}");
        }
    }
}

#[tokio::test]
async fn a_body_that_is_too_large_or_no_json_is_refused_before_anything_is_done() {
    let bench = Bench::new();
    let operator = bench.token.clone();
    let large = format!("{{\"order\":\"{}\"}}", "x".repeat(router::BODY_LIMIT));
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
            assert!(!bench.ask(asked).await.refused(status).is_empty(), "{path}");
        }
    }
    assert!(!bench.stopped());
}

#[tokio::test]
async fn a_query_that_no_route_knows_is_refused_where_members_are_taken() {
    let bench = Bench::new();
    let offers = api::offers().into_iter();
    for offer in offers.filter(|it| it.method == Method::Get && !it.members.is_empty()) {
        let path = format!("{}?hastily_typed=1", offer.path);
        let answer = bench.get(&path).await;
        assert!([400, 404].contains(&answer.status.as_u16()), "{path}");
    }
}

#[tokio::test]
async fn a_session_that_has_run_out_or_was_ended_orders_nothing() {
    let bench = Bench::new();
    let mut register = Register::open(&bench.db.with_file_name("people.db")).unwrap();
    let long_ago_us = jiff::Timestamp::now().as_microsecond() - 13 * 3_600_000_000;
    let session = register.log_in("li", PASSWORD, long_ago_us).unwrap();
    let (_, old) = session.unwrap();
    let ended = bench.token.clone();
    let out = request("POST", "/api/logout", Some(&ended), "{}");
    assert_eq!(bench.ask(out).await.status, 200);
    for token in [old.as_str(), &ended, "", "0123", &"f".repeat(64)] {
        let asked = request("POST", "/api/orders", Some(token), r#"{"order":"stop"}"#);
        assert!(bench.ask(asked).await.refused(401).contains("log in"));
    }
    assert!(!bench.stopped());
}

#[tokio::test]
async fn a_path_that_climbs_leads_nowhere() {
    let bench = Bench::new();
    for path in [
        "/../etc/passwd",
        "/api/../../etc/passwd",
        "/%2e%2e/%2e%2e/etc/passwd",
        "/api/history/..%2f..%2fpeople.db",
        "/api/history/report/%00",
        "/api/orders/",
        "/api//orders",
        "/API/VIEW",
        "/api/view;x=1",
    ] {
        assert!(!bench.get(path).await.refused(404).is_empty(), "{path}");
    }
}
