//! Tests of people: set-up of the first engineer, changes by an engineer, one's own password, the audit of all.

use super::*;
use ::history::{Archive, Filter, OrderChoice, OrderRecord, Row, Store};
use axum::http::header::SET_COOKIE;
use serde_json::{Value, json};

impl Fixture {
    pub(super) async fn post(&self, path: &str, token: Option<&str>, body: Value) -> Answer {
        let mut request = Request::post(path).header("content-type", "application/json");
        if let Some(token) = token {
            request = request.header("authorization", format!("Bearer {token}"));
        }
        self.ask(request.body(body.to_string().into()).unwrap())
            .await
    }

    async fn change_person(&self, token: &str, body: Value) -> Answer {
        self.post("/api/people/change", Some(token), body).await
    }

    async fn log_in(&self, user: &str, password: &str) -> Answer {
        let body = json!({"user": user, "password": password});
        self.post("/api/login", None, body).await
    }

    async fn get_as(&self, token: &str, path: &str) -> Answer {
        let request = Request::get(path).header("authorization", format!("Bearer {token}"));
        self.ask(request.body(Body::empty()).unwrap()).await
    }

    async fn people(&self, token: &str) -> Value {
        let answer = self.get_as(token, "/api/people").await;
        assert_eq!(answer.status, 200, "{}", answer.text());
        answer.json()
    }

    /// Returns the audit as lines: who, what, refusal.
    fn lines(&self) -> Vec<String> {
        let archive = Archive::open(&self.db).unwrap();
        let orders = archive
            .orders(&Filter::default(), &OrderChoice::default())
            .unwrap();
        let line = |it: ::history::OrderEntry| {
            let refused = it.refused.unwrap_or_default();
            format!("{} {} {} {refused}", it.who, it.role, it.what)
        };
        orders.into_iter().map(line).collect()
    }
}

#[tokio::test]
async fn the_setup_code_adds_the_first_engineer_once() {
    let fixture = Fixture::new();
    let needed = async || fixture.get("/api/setup/needed").await.json()["needed"].clone();
    assert_eq!(needed().await, true, "only an operator and a maintainer");
    let set_up = async |code: &str, user: &str| {
        let body = json!({"code": code, "user": user, "password": PASSWORD});
        fixture.post("/api/setup", None, body).await
    };
    set_up("AAAA-AAAA", "zhao").await.refused(401);
    let code = fixture.setup.to_string();
    let taken = set_up(&code, "li").await.refused(409);
    assert!(taken.contains("li"), "{taken}");
    let session = set_up(&code.to_lowercase(), "zhao").await;
    assert_eq!(session.json()["role"], "engineer", "{}", session.text());
    assert!(session.headers.contains_key(SET_COOKIE));
    assert_eq!(needed().await, false);
    set_up(&code, "sun").await.refused(401);
    let lines = fixture.lines();
    assert_eq!(lines.len(), 4, "{lines:#?}");
    assert!(
        lines[0].starts_with(r#"  {"order":"login"} the set-up code"#),
        "{lines:#?}"
    );
    let first = r#"zhao engineer {"change":"set_up","name":"zhao","order":"people"} "#;
    assert_eq!(lines[2], first);
}

#[tokio::test]
async fn an_engineer_changes_people_and_the_audit_names_them() {
    let fixture = Fixture::new();
    let token = fixture.session(Role::Engineer);
    let add = json!({"change": "add", "name": "sun", "role": "operator", "password": "first-one"});
    let answer = fixture.change_person(&token, add).await;
    assert_eq!(
        answer.json(),
        json!({"password": null}),
        "{}",
        answer.text()
    );
    assert_eq!(fixture.log_in("sun", "first-one").await.status, 200);
    let role = json!({"change": "role", "name": "sun", "role": "maintainer"});
    fixture.change_person(&token, role).await;
    let drawn = fixture
        .change_person(&token, json!({"change": "password", "name": "sun"}))
        .await;
    let drawn = drawn.json()["password"].as_str().unwrap().to_owned();
    fixture.log_in("sun", "first-one").await.refused(401);
    let session = fixture.log_in("sun", &drawn).await;
    assert_eq!(session.json()["role"], "maintainer");
    let listed = fixture.people(&token).await;
    let sun = listed
        .as_array()
        .unwrap()
        .iter()
        .find(|it| it["name"] == "sun")
        .unwrap();
    assert_eq!(
        (&sun["role"], &sun["locked_until"]),
        (&json!("maintainer"), &Value::Null)
    );
    assert!(sun["since"].is_string());
    fixture
        .change_person(&token, json!({"change": "remove", "name": "sun"}))
        .await;
    let gone = session.json()["token"].as_str().unwrap().to_owned();
    fixture
        .post("/api/orders", Some(&gone), json!({"order": "stop"}))
        .await
        .refused(401);
    let lines = fixture.lines();
    for (line, expected) in lines.iter().zip([
        r#"engineer engineer {"change":"add","name":"sun","order":"people","role":"operator"} "#,
        r#"engineer engineer {"change":"role","name":"sun","order":"people","role":"maintainer"} "#,
        r#"engineer engineer {"change":"password","name":"sun","order":"people"} "#,
        r#"sun  {"order":"login"} user name or password is wrong"#,
        r#"engineer engineer {"change":"remove","name":"sun","order":"people"} "#,
    ]) {
        assert_eq!(line, expected);
    }
    assert_eq!(lines.len(), 5, "{lines:#?}");
}

#[tokio::test]
async fn a_refused_change_says_why_and_is_audited() {
    let fixture = Fixture::new();
    let token = fixture.session(Role::Engineer);
    for (change, status) in [
        (
            json!({"change": "add", "name": "li", "role": "operator"}),
            409,
        ),
        (
            json!({"change": "add", "name": "a b", "role": "operator"}),
            400,
        ),
        (
            json!({"change": "add", "name": "sun", "role": "operator", "password": "short"}),
            400,
        ),
        (
            json!({"change": "role", "name": "sun", "role": "operator"}),
            404,
        ),
        (json!({"change": "unlock", "name": "sun"}), 404),
        (
            json!({"change": "role", "name": "engineer", "role": "operator"}),
            409,
        ),
        (json!({"change": "remove", "name": "engineer"}), 409),
    ] {
        let answer = fixture.change_person(&token, change).await;
        answer.refused(status);
        assert!(answer.json()["reason_zh"].is_string(), "{}", answer.text());
    }
    assert_eq!(fixture.lines().len(), 7);
    for malformed in [
        json!({"change": "add", "name": "sun", "role": "chief"}),
        json!({"change": "add", "name": "sun"}),
        json!({"change": "fire", "name": "li"}),
        json!({"change": "unlock", "name": "li", "minutes": 5}),
    ] {
        fixture.change_person(&token, malformed).await.refused(400);
    }
}

/// Expects 401 without a login, 403 for an operator and a maintainer, 200 for an engineer.
#[tokio::test]
async fn only_an_engineer_changes_people() {
    let fixture = Fixture::new();
    let tokens = Role::ALL.map(|role| fixture.session(role));
    let change = json!({"change": "unlock", "name": "li"});
    let path = "/api/people/change";
    fixture.post(path, None, change.clone()).await.refused(401);
    for (token, expected) in tokens.iter().zip([403, 403, 200]) {
        let answer = fixture.change_person(token, change.clone()).await;
        assert_eq!(answer.status, expected, "{}", answer.text());
    }
    let lines = fixture.lines();
    assert!(
        lines[0].contains("this takes the role engineer"),
        "{lines:#?}"
    );
}

#[tokio::test]
async fn a_new_own_password_ends_other_sessions() {
    let fixture = Fixture::new();
    let here = fixture.token.clone();
    let elsewhere = fixture.log_in("li", PASSWORD).await.json()["token"].clone();
    let own = async |present: &str, new: &str| {
        let body = json!({"present": present, "new": new});
        fixture.post("/api/password", Some(&here), body).await
    };
    own("wrong one", "another-1").await.refused(401);
    own(PASSWORD, "short").await.refused(400);
    let session = own(PASSWORD, "another-1").await;
    let token = session.json()["token"].as_str().unwrap().to_owned();
    let stop = json!({"order": "stop"});
    let stopped = async |token: &str| fixture.post("/api/orders", Some(token), stop.clone()).await;
    stopped(elsewhere.as_str().unwrap()).await.refused(401);
    assert_eq!(stopped(&token).await.status, 200);
    fixture.log_in("li", PASSWORD).await.refused(401);
    let lines = fixture.lines();
    let changed = r#"li operator {"change":"password","name":"li","order":"people"} "#;
    assert_eq!(lines[2], changed, "{lines:#?}");
}

#[tokio::test]
async fn an_audit_that_waits_delays_no_session() {
    let fixture = Fixture::new();
    let token = fixture.session(Role::Engineer);
    drop(::history::Store::open(&fixture.db).unwrap());
    let locked = rusqlite::Connection::open(&fixture.db).unwrap();
    locked.execute_batch("BEGIN IMMEDIATE").unwrap();
    let change = fixture.change_person(&token, json!({"change": "unlock", "name": "li"}));
    let others = async {
        for _ in 0..20 {
            let request = Request::get("/api/me").header("authorization", fixture.bearer());
            let answer = fixture.ask(request.body(Body::empty()).unwrap()).await;
            assert_eq!(answer.json()["name"], "li");
        }
        locked.execute_batch("ROLLBACK").unwrap();
    };
    let (changed, ()) = tokio::join!(change, others);
    assert_eq!(changed.status, 200, "{}", changed.text());
}

#[tokio::test]
async fn an_engineer_unlocks_a_person_at_once() {
    let fixture = Fixture::new();
    let token = fixture.session(Role::Engineer);
    for _ in 0..5 {
        fixture.log_in("wang", "guess no. 1").await.refused(401);
    }
    fixture.log_in("wang", PASSWORD).await.refused(429);
    let listed = fixture.people(&token).await;
    let locked = |name: &str| {
        let all = listed.as_array().unwrap();
        all.iter()
            .any(|it| it["name"] == name && it["locked_until"].is_string())
    };
    assert!(locked("wang") && !locked("li"), "{listed}");
    fixture
        .change_person(&token, json!({"change": "unlock", "name": "wang"}))
        .await;
    assert_eq!(fixture.log_in("wang", PASSWORD).await.status, 200);
    let failures = fixture
        .lines()
        .iter()
        .filter(|it| it.starts_with("wang  "))
        .count();
    assert_eq!(failures, 5, "a try that waits leaves no line");
}

#[tokio::test]
async fn a_password_typed_as_user_name_reaches_no_file() {
    let fixture = Fixture::new();
    fixture.log_in("my-secret-word", "x").await.refused(401);
    assert!(
        fixture.lines()[0].starts_with("  {"),
        "{:?}",
        fixture.lines()
    );
    for entry in std::fs::read_dir(fixture.db.parent().unwrap()).unwrap() {
        let path = entry.unwrap().path();
        if path.is_file() {
            let bytes = std::fs::read(&path).unwrap();
            assert!(
                !bytes.windows(14).any(|it| it == b"my-secret-word"),
                "{}",
                path.display()
            );
        }
    }
}

#[tokio::test]
async fn logins_and_people_are_for_engineers_alone() {
    let fixture = Fixture::new();
    let engineer = fixture.session(Role::Engineer);
    let maintainer = fixture.session(Role::Maintainer);
    let add = json!({"change": "add", "name": "sun", "role": "operator", "password": "first-one"});
    fixture.change_person(&engineer, add).await;
    fixture.log_in("sun", "wrong-one").await.refused(401);
    let start = OrderRecord {
        what: r#"{"order":"start"}"#.into(),
        ..OrderRecord::default()
    };
    let mut store = Store::open(&fixture.db).unwrap();
    store.record(&[Row::Order(start)]).unwrap();
    let words = |answer: Answer| -> Vec<String> {
        let all = answer.json();
        let all = all.as_array().unwrap().iter();
        all.map(|it| it["what"]["order"].as_str().unwrap().to_owned())
            .collect()
    };
    const ALL: &str = "/api/history/orders";
    let (mine, others) = (
        words(fixture.get_as(&engineer, ALL).await),
        words(fixture.get_as(&maintainer, ALL).await),
    );
    assert_eq!(mine, ["people", "login", "start"]);
    assert_eq!(others, ["start"]);
    assert_eq!(others, words(fixture.get(ALL).await));
    let newest = fixture
        .get_as(&engineer, "/api/history/orders?offset=1&limit=1")
        .await;
    assert_eq!(words(newest), ["login"]);
    let logins = "/api/history/orders?order=login";
    fixture.get(logins).await.refused(401);
    fixture.get_as(&maintainer, logins).await.refused(403);
    assert_eq!(words(fixture.get_as(&engineer, logins).await), ["login"]);
}
