//! Tests of login, logout and sessions.

use super::*;
use axum::http::header::{COOKIE, RETRY_AFTER, SET_COOKIE};

fn post(path: &str, body: String) -> Request<Body> {
    let request = Request::post(path).header("content-type", "application/json");
    request.body(body.into()).unwrap()
}

fn login(user: &str, password: &str) -> Request<Body> {
    let body = serde_json::json!({ "user": user, "password": password });
    post("/api/login", body.to_string())
}

fn with_cookie(mut request: Request<Body>, cookie: &str) -> Request<Body> {
    request
        .headers_mut()
        .insert(COOKIE, cookie.parse().unwrap());
    request
}

#[tokio::test]
async fn a_login_opens_a_session_for_page_and_scripts() {
    let fixture = Fixture::new();
    let answer = fixture.ask(login("li", PASSWORD)).await;
    assert_eq!(answer.status, 200, "{}", answer.text());
    assert_eq!(answer.json()["name"], "li");
    assert_eq!(answer.json()["role"], "operator");
    let cookie = answer.headers[SET_COOKIE].to_str().unwrap();
    for part in ["HttpOnly", "SameSite=Strict", "Path=/", "Max-Age=43200"] {
        assert!(cookie.contains(part), "{cookie}");
    }
    let pair = cookie.split(';').next().unwrap();
    let me = Request::get("/api/me").body(Body::empty()).unwrap();
    let me = fixture
        .ask(with_cookie(me, &format!("theme=dark; {pair}")))
        .await;
    assert_eq!(me.json()["name"], "li");
    let token = answer.json()["token"].as_str().unwrap().to_owned();
    let me = Request::get("/api/me").header("authorization", format!("Bearer {token}"));
    let me = fixture.ask(me.body(Body::empty()).unwrap()).await;
    assert_eq!(me.json()["role"], "operator");
}

#[tokio::test]
async fn without_login_reading_works_and_orders_do_not() {
    let fixture = Fixture::new();
    assert!(fixture.get("/api/me").await.json().is_null());
    assert_eq!(fixture.get("/api/view").await.status, 200);
    let order = post("/api/orders", r#"{"order":"stop"}"#.to_owned());
    assert!(
        fixture
            .ask(order)
            .await
            .refused(401)
            .contains("log in first")
    );
    let stolen = post("/api/orders", r#"{"order":"stop"}"#.to_owned());
    let stolen = with_cookie(stolen, &format!("relayrig_session={}", "0".repeat(64)));
    fixture.ask(stolen).await.refused(401);
    assert!(!fixture.stopped());
}

#[tokio::test]
async fn logout_ends_the_session() {
    let fixture = Fixture::new();
    let cookie = format!("relayrig_session={}", fixture.token);
    let out = fixture
        .ask(with_cookie(post("/api/logout", String::new()), &cookie))
        .await;
    assert_eq!(out.status, 200);
    assert!(
        out.headers[SET_COOKIE]
            .to_str()
            .unwrap()
            .contains("Max-Age=0")
    );
    fixture.order(r#"{"order":"stop"}"#).await.refused(401);
    assert!(!fixture.stopped());
}

#[tokio::test]
async fn the_sixth_try_waits_even_with_the_right_password() {
    let fixture = Fixture::new();
    for _ in 0..5 {
        let refused = fixture.ask(login("wang", "guess no. 1")).await.refused(401);
        assert_eq!(refused, "user name or password is wrong");
    }
    let answer = fixture.ask(login("wang", PASSWORD)).await;
    answer.refused(429);
    let seconds: u64 = answer.headers[RETRY_AFTER]
        .to_str()
        .unwrap()
        .parse()
        .unwrap();
    assert!((1..=300).contains(&seconds), "{seconds}");
    assert_eq!(fixture.ask(login("li", PASSWORD)).await.status, 200);
}

#[tokio::test]
async fn login_from_another_site_or_without_password_is_refused() {
    let fixture = Fixture::new();
    let mut foreign = login("li", PASSWORD);
    foreign
        .headers_mut()
        .insert("sec-fetch-site", "cross-site".parse().unwrap());
    fixture.ask(foreign).await.refused(403);
    for body in ["", "{}", r#"{"user":"li"}"#, r#"{"user":1,"password":"x"}"#] {
        fixture
            .ask(post("/api/login", body.to_owned()))
            .await
            .refused(400);
    }
}
