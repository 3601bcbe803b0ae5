//! Tests of new recipes and of their approval by a second engineer.

use super::*;
use serde_json::{Value, json};

impl Fixture {
    /// Creates a server of a plant that requires approval by a second engineer, with the engineers `zhao` and `chen`.
    fn of_two_engineers() -> Self {
        let fixture = Self::new();
        let rig = fixture.db.with_file_name("config").join("rig.toml");
        let text = std::fs::read_to_string(&rig).unwrap();
        std::fs::write(rig, text + "\n[recipes]\napproval = \"second_person\"\n").unwrap();
        for name in ["zhao", "chen"] {
            fixture
                .register()
                .add(name, Role::Engineer, PASSWORD, 0)
                .unwrap();
        }
        fixture
    }

    async fn shown(&self, name: &str) -> Value {
        self.get(&format!("/api/recipes/show?name={name}"))
            .await
            .json()
    }

    fn token(&self, who: &str) -> String {
        let now_us = jiff::Timestamp::now().as_microsecond();
        self.register().open_session(who, now_us).unwrap()
    }

    /// Saves recipe `customer-a` from the shipped one; returns its hash.
    async fn saved_as(&self, who: &str) -> Value {
        let from = self.shown("jzc-22f-012").await["hash"].clone();
        let body = json!({"name": "jzc-22f-012", "from": from, "reason": "customer A", "save_as": "customer-a",
            "values": {"limits.operate_voltage_v.high": 8.75}});
        let saved = self
            .post("/api/recipes/revise", Some(&self.token(who)), body)
            .await;
        assert_eq!(saved.status, 200, "{}", saved.text());
        saved.json()["hash"].clone()
    }

    async fn sign(&self, who: &str, hash: &Value) -> Answer {
        let body = json!({"name": "customer-a", "hash": hash});
        self.post("/api/recipes/approve", Some(&self.token(who)), body)
            .await
    }
}

fn signers(shown: &Value) -> (bool, Vec<&str>) {
    let signed = shown["approval"]["signatures"].as_array().unwrap();
    let names = signed.iter().map(|it| it["who"].as_str().unwrap());
    (shown["approval"]["approved"] == true, names.collect())
}

#[tokio::test]
async fn a_second_engineer_approves_what_the_first_saved() {
    let fixture = Fixture::of_two_engineers();
    let hash = fixture.saved_as("zhao").await;
    let shown = fixture.shown("customer-a").await;
    assert_eq!(signers(&shown), (false, vec!["zhao"]));
    let own = fixture.sign("zhao", &hash).await;
    assert!(own.refused(409).contains("another engineer approves it"));
    let weak = fixture.sign("li", &hash).await;
    assert!(weak.refused(403).contains("role engineer"));
    let approved = fixture.sign("chen", &hash).await;
    assert_eq!(signers(&approved.json()), (true, vec!["zhao", "chen"]));
    let listed = fixture.get("/api/recipes").await.json();
    let states = listed.as_array().unwrap().iter();
    let states: Vec<_> = states
        .map(|it| (it["name"].as_str().unwrap(), it["approved"] == true))
        .collect();
    let expected = [
        ("customer-a", true),
        ("jzc-22f-006", false),
        ("jzc-22f-012", false),
    ];
    assert_eq!(states, expected);
}

#[tokio::test]
async fn a_changed_text_loses_its_approval() {
    let fixture = Fixture::of_two_engineers();
    let hash = fixture.saved_as("zhao").await;
    assert_eq!(fixture.sign("chen", &hash).await.status, 200);
    let file = fixture
        .db
        .with_file_name("config")
        .join("recipes/customer-a.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    std::fs::write(file, text.replace("8.75", "8.85")).unwrap();
    assert_eq!(signers(&fixture.shown("customer-a").await), (false, vec![]));
    let late = fixture.sign("chen", &hash).await;
    assert!(
        late.refused(409).contains("no longer the newest"),
        "{}",
        late.text()
    );
    let edited = fixture.shown("customer-a").await["hash"].clone();
    for (who, expected) in [("chen", false), ("zhao", true)] {
        let approved = fixture.sign(who, &edited).await;
        assert_eq!(approved.json()["approval"]["approved"], expected);
    }
}

#[tokio::test]
async fn a_plant_without_the_key_shows_no_approval() {
    let fixture = Fixture::new();
    fixture
        .register()
        .add("zhao", Role::Engineer, PASSWORD, 0)
        .unwrap();
    fixture.saved_as("zhao").await;
    assert_eq!(fixture.shown("customer-a").await["approval"], Value::Null);
    let listed = fixture.get("/api/recipes").await.json();
    assert!(
        listed
            .as_array()
            .unwrap()
            .iter()
            .all(|it| it["approved"] == true)
    );
}
