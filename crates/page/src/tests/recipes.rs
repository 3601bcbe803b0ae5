//! Tests of recipes over HTTP: reading, revising, and the refusals of both.

use super::*;
use ::history::{Archive, Filter, OrderChoice, OrderEntry};
use serde_json::{Value, json};

impl Fixture {
    async fn revise(&self, token: Option<&str>, body: impl Into<Body>) -> Answer {
        let mut request =
            Request::post("/api/recipes/revise").header("content-type", "application/json");
        if let Some(token) = token {
            request = request.header("authorization", format!("Bearer {token}"));
        }
        self.ask(request.body(body.into()).unwrap()).await
    }

    async fn newest(&self) -> Value {
        let answer = self.get("/api/recipes/show?name=jzc-22f-012").await;
        assert_eq!(answer.status, 200, "{}", answer.text());
        answer.json()
    }

    /// Returns a change of the newest revision as a page sends it.
    async fn change(&self, values: Value) -> String {
        json!({"name": "jzc-22f-012", "from": self.newest().await["hash"], "reason": "tighter", "values": values})
            .to_string()
    }

    fn recipe_text(&self) -> String {
        std::fs::read_to_string(
            self.db
                .with_file_name("config")
                .join("recipes/jzc-22f-012.toml"),
        )
        .unwrap()
    }

    fn audit(&self) -> Vec<OrderEntry> {
        let archive = Archive::open(&self.db).unwrap();
        archive
            .orders(&Filter::default(), &OrderChoice::default())
            .unwrap()
    }
}

#[tokio::test]
async fn every_recipe_is_listed_faulty_ones_with_errors() {
    let fixture = Fixture::new();
    let broken = fixture
        .db
        .with_file_name("config")
        .join("recipes/broken.toml");
    std::fs::write(broken, "name = \"broken\"\n").unwrap();
    let listed = fixture.get("/api/recipes").await.json();
    let names: Vec<&str> = listed
        .as_array()
        .unwrap()
        .iter()
        .map(|it| it["name"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["broken", "jzc-22f-006", "jzc-22f-012"]);
    assert!(
        listed[0]["trouble"]
            .as_str()
            .unwrap()
            .contains("found nothing"),
        "{listed}"
    );
    assert_eq!(
        (&listed[2]["number"], &listed[2]["trouble"]),
        (&json!(1), &json!(null))
    );
    assert!(listed[2]["title_zh"].as_str().unwrap().contains("继电器"));
}

#[tokio::test]
async fn recipes_need_a_rig_file_without_faults() {
    let fixture = Fixture::new();
    let rig = fixture.db.with_file_name("config").join("rig.toml");
    std::fs::write(rig, "line = 7").unwrap();
    for path in ["/api/recipes", "/api/recipes/show?name=jzc-22f-012"] {
        let why = fixture.get(path).await.refused(500);
        assert!(why.contains("rig.toml"), "{why}");
    }
}

#[tokio::test]
async fn a_revision_has_form_unit_range_value_per_key() {
    let shown = Fixture::new().newest().await;
    let fields = shown["fields"].as_array().unwrap();
    let field = fields
        .iter()
        .find(|it| it["path"] == "limits.operate_voltage_v.high")
        .unwrap();
    assert_eq!(
        *field,
        json!({"path": "limits.operate_voltage_v.high", "form": "number", "unit": "V", "low": 0.0, "low_allowed": true,
            "high": 1000.0, "optional": true, "value": 9.0})
    );
}

#[tokio::test]
async fn a_revision_of_files_in_memory_is_not_kept() {
    let folder = new_folder();
    let fixture = Fixture::with(folder.join("history.db"), Folder::built_in());
    let engineer = fixture.session(Role::Engineer);
    let first = fixture.newest().await;
    assert_eq!(
        (&first["kept"], &first["saved_at_us"]),
        (&json!(false), &json!(null))
    );
    let change = fixture
        .change(json!({"limits.operate_voltage_v.high": 8.75}))
        .await;
    let saved = fixture.revise(Some(&engineer), change).await;
    assert_eq!(saved.status, 200, "{}", saved.text());
    assert_eq!(fixture.newest().await, saved.json());
    assert_eq!(fixture.audit().len(), 1);
    assert!(!folder.join("config").exists());
}

#[tokio::test]
async fn an_engineer_revises_and_earlier_revisions_remain() {
    let fixture = Fixture::new();
    let engineer = fixture.session(Role::Engineer);
    let old = fixture.newest().await;
    let change = fixture
        .change(json!({"limits.operate_voltage_v.high": 8.75}))
        .await;
    let saved = fixture.revise(Some(&engineer), change).await;
    assert_eq!(saved.status, 200, "{}", saved.text());
    assert_eq!(saved.json()["number"], 2);
    assert_eq!(fixture.newest().await, saved.json());
    assert!(fixture.recipe_text().contains("high = 8.75"));
    let first = fixture
        .get("/api/recipes/show?name=jzc-22f-012&revision=1")
        .await
        .json();
    assert_eq!(
        (&first["hash"], &first["newest"]),
        (&old["hash"], &json!(2))
    );
    let [noted] = fixture.audit().try_into().unwrap();
    assert_eq!(
        (noted.who.as_str(), noted.role.as_str(), noted.refused),
        ("engineer", "engineer", None)
    );
    assert_eq!(noted.what["order"], "revise");
    assert_eq!(
        (&noted.what["revision"], &noted.what["from"]),
        (&json!(2), &old["hash"])
    );
    assert_eq!(
        noted.what["values"],
        json!({"limits.operate_voltage_v.high": 8.75})
    );
}

#[tokio::test]
async fn the_audit_has_refused_revisions_of_known_persons_only() {
    let fixture = Fixture::new();
    let before = fixture.recipe_text();
    let change = fixture.change(json!({"decision.slow_repeats": 4})).await;
    assert!(
        fixture
            .revise(None, change.clone())
            .await
            .refused(401)
            .contains("log in")
    );
    assert!(!fixture.db.exists());
    for role in [Role::Operator, Role::Maintainer] {
        let token = fixture.session(role);
        let refused = fixture
            .revise(Some(&token), change.clone())
            .await
            .refused(403);
        assert_eq!(
            refused,
            format!("this takes the role engineer; you are {role}")
        );
        assert_eq!(fixture.audit().last().unwrap().refused, Some(refused));
    }
    assert_eq!(fixture.recipe_text(), before);
}

#[tokio::test]
async fn a_refused_value_names_its_key_and_changes_nothing() {
    let fixture = Fixture::new();
    let engineer = fixture.session(Role::Engineer);
    let before = fixture.recipe_text();
    for (values, key) in [
        (
            json!({"limits.operate_voltage_v.high": 99}),
            "limits.operate_voltage_v.high",
        ),
        (json!({"part.body_mm": [22.5, 0, 16.5]}), "part.body_mm.1"),
        (json!({"part.nominal_v": "NaN"}), "part.nominal_v"),
        (json!({"hastily.typed": 1}), "hastily.typed"),
        (json!({"passwd": 1}), "passwd"),
        (json!({"title_en": {"a": 1}}), "title_en"),
    ] {
        let change = fixture.change(values).await;
        let answer = fixture.revise(Some(&engineer), change).await;
        let reason = answer.refused(400);
        assert_eq!(answer.json()["key"], key, "{reason}");
        assert!(answer.json()["found"].is_string() && answer.json()["expected"].is_string());
        assert_eq!(fixture.audit().last().unwrap().refused, Some(reason));
    }
    assert_eq!(fixture.recipe_text(), before);
}

#[tokio::test]
async fn a_refused_value_has_its_requirement_as_a_code() {
    let fixture = Fixture::new();
    let engineer = fixture.session(Role::Engineer);
    for (values, requirement) in [
        (
            json!({"limits.operate_voltage_v.high": -1}),
            json!({"code": "form"}),
        ),
        (
            json!({"limits.operate_voltage_v.high": 99}),
            json!({"code": "other"}),
        ),
        (
            json!({"limits.release_voltage_v.low": 5, "limits.release_voltage_v.high": 4}),
            json!({"code": "at_most_high", "value": "4"}),
        ),
        (
            json!({"test.prebias_v": 9}),
            json!({"code": "below", "value": "7.88 V"}),
        ),
    ] {
        let change = fixture.change(values).await;
        let answer = fixture.revise(Some(&engineer), change).await;
        assert_eq!(answer.json()["requirement"], requirement);
    }
}

#[tokio::test]
async fn a_second_revision_is_refused_in_both_languages() {
    let fixture = Fixture::new();
    let engineer = fixture.session(Role::Engineer);
    let first = fixture.change(json!({"decision.slow_repeats": 4})).await;
    let second = fixture.change(json!({"decision.slow_repeats": 5})).await;
    assert_eq!(fixture.revise(Some(&engineer), first).await.status, 200);
    let before = fixture.recipe_text();
    let answer = fixture.revise(Some(&engineer), second).await;
    assert!(
        answer
            .refused(409)
            .contains("no longer the newest, which is 2")
    );
    assert!(
        answer.json()["reason_zh"]
            .as_str()
            .unwrap()
            .contains("第 2 版")
    );
    assert_eq!(fixture.recipe_text(), before);
}

#[tokio::test]
async fn an_empty_change_is_refused_before_reading_files() {
    let fixture = Fixture::new();
    let engineer = fixture.session(Role::Engineer);
    let before = fixture.recipe_text();
    let large = format!("{{\"name\":\"{}\"}}", "x".repeat(asked::BODY_LIMIT));
    let hash = fixture.newest().await["hash"].clone();
    for (body, status) in [
        (large, 413),
        ("{".into(), 400),
        ("[]".into(), 400),
        ("{}".into(), 400),
        (
            json!({"name": "jzc-22f-012", "from": hash, "reason": "x", "values": {}, "why": "x"})
                .to_string(),
            400,
        ),
        (
            format!(
                "{{\"name\":\"jzc-22f-012\",\"from\":{hash},\"reason\":\"x\",\"values\":{{\"part.nominal_v\":NaN}}}}"
            ),
            400,
        ),
        (
            format!(
                "{{\"name\":\"jzc-22f-012\",\"from\":{hash},\"reason\":\"x\",\"values\":{{\"part.nominal_v\":1e999}}}}"
            ),
            400,
        ),
        (
            json!({"name": "jzc-22f-012", "from": hash, "reason": "x", "values": {}}).to_string(),
            400,
        ),
        (
            json!({"name": "../rig", "from": hash, "reason": "x", "values": {}}).to_string(),
            404,
        ),
        (
            json!({"name": "revisions/jzc-22f-012/1", "from": hash, "reason": "x", "values": {}})
                .to_string(),
            404,
        ),
        (
            json!({"name": "jzc-22f-012", "from": "", "reason": "x", "values": {}}).to_string(),
            409,
        ),
    ] {
        let said = body.chars().take(90).collect::<String>();
        let answer = fixture.revise(Some(&engineer), body).await;
        assert!(!answer.refused(status).is_empty(), "{said}");
    }
    assert_eq!(fixture.recipe_text(), before);
}

#[tokio::test]
async fn without_an_audit_nothing_is_changed() {
    let fixture = Fixture::new();
    let engineer = fixture.session(Role::Engineer);
    let before = fixture.recipe_text();
    let change = fixture.change(json!({"decision.slow_repeats": 4})).await;
    std::fs::write(
        &fixture.db,
        "this is a letter, not a database\n".repeat(100),
    )
    .unwrap();
    let reason = fixture.revise(Some(&engineer), change).await.refused(500);
    assert!(reason.contains("is not a relayrig history"), "{reason}");
    assert_eq!(fixture.recipe_text(), before);
}

#[tokio::test]
async fn the_process_card_of_a_recipe_prints() {
    let fixture = Fixture::new();
    for (lang, word) in [("zh", "继电器"), ("en", "changeover")] {
        let answer = fixture
            .get(&format!("/api/recipes/card?name=jzc-22f-012&lang={lang}"))
            .await;
        assert_eq!(answer.status, 200, "{}", answer.text());
        assert!(answer.text().contains(word) && !answer.text().contains("<script"));
        let named = fixture.get_in(lang, "/api/recipes/card?name=jzc-22f-012");
        assert!(named.await.text().contains(word));
    }
    fixture
        .get("/api/recipes/card?name=..%2Frig")
        .await
        .refused(404);
}

#[tokio::test]
async fn an_unknown_recipe_or_revision_is_404() {
    let fixture = Fixture::new();
    for query in [
        "name=..%2Frig",
        "name=",
        "name=jzc-22f-012&revision=7",
        "name=jzc-22f-012&revision=0",
    ] {
        fixture
            .get(&format!("/api/recipes/show?{query}"))
            .await
            .refused(404);
    }
    for query in ["", "name=jzc-22f-012&revision=-1", "name=jzc-22f-012&rev=1"] {
        fixture
            .get(&format!("/api/recipes/show?{query}"))
            .await
            .refused(400);
    }
}

#[tokio::test]
async fn a_revision_shows_who_changed_what_and_why() {
    let fixture = Fixture::new();
    let engineer = fixture.session(Role::Engineer);
    let change = fixture
        .change(
            json!({"limits.operate_voltage_v.high": 8.75, "limits.coil_resistance_ohm.high": null}),
        )
        .await;
    assert_eq!(fixture.revise(Some(&engineer), change).await.status, 200);
    let path = "/api/recipes/revisions?name=jzc-22f-012";
    let shown = fixture.get(path).await.json();
    let [revision] = &shown.as_array().unwrap()[..] else {
        panic!("one revision")
    };
    assert_eq!(
        (
            &revision["revision"],
            &revision["who"],
            &revision["role"],
            &revision["reason"]
        ),
        (
            &json!(2),
            &json!("engineer"),
            &json!("engineer"),
            &json!("tighter")
        )
    );
    assert_eq!(
        revision["lines"],
        json!([
            "limits.coil_resistance_ohm.high: 440.0 ohm -> -",
            "limits.operate_voltage_v.high: 9.0 V -> 8.75 V"
        ])
    );
    assert_eq!(revision["changes"][1]["old"], 9.0);
    let wrong = "/api/recipes/revisions?name=jzc-22f-013";
    fixture.get(wrong).await.refused(404);
}

#[tokio::test]
async fn a_revision_without_reason_is_refused() {
    let fixture = Fixture::new();
    let engineer = fixture.session(Role::Engineer);
    let before = fixture.recipe_text();
    let change = fixture.change(json!({"decision.slow_repeats": 4})).await;
    let mut change: Value = serde_json::from_str(&change).unwrap();
    change["reason"] = " ".into();
    let blank = fixture.revise(Some(&engineer), change.to_string()).await;
    assert!(blank.refused(400).contains("why the values change"));
    assert!(blank.json()["reason_zh"].as_str().unwrap().contains("原因"));
    change.as_object_mut().unwrap().remove("reason");
    let absent = fixture.revise(Some(&engineer), change.to_string()).await;
    assert_eq!(
        absent.refused(400),
        "reason: found nothing, expected a value"
    );
    assert_eq!(fixture.recipe_text(), before);
}
