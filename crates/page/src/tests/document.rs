//! Calls every route from the OpenAPI document alone, in every role; checks that each refuses an unknown member.

use super::api::{askers, request};
use super::*;
use ::history::{
    AlarmRecord, LotRecord, MeasurementRecord, OrderRecord, PartRecord, Row, Store, snapshot_hash,
};
use serde_json::{Map, Value, json};

/// Routes that the test of successful answers leaves out: a stream without end, and routes that other tests call: to
/// end sessions or change people (`login.rs`, `people.rs`), for a lot that needs results from outside of the rig
/// (`external.rs`), with a second engineer (`approval.rs`), and with a plan
/// under way (`plans.rs`).
const APART: [&str; 13] = [
    "/api/events",
    "/api/lots/external",
    "/api/logout",
    "/api/password",
    "/api/people/change",
    "/api/plans/abandon",
    "/api/plans/paper",
    "/api/plans/show",
    "/api/plans/start",
    "/api/plans/tick",
    "/api/plans/untick",
    "/api/recipes/approve",
    "/api/setup",
];

/// A call made from the document.
#[derive(Debug, Clone)]
struct Call {
    method: String,
    path: String,
    query: Vec<(String, String)>,
    body: Option<Value>,
    /// Weakest role that the document demands.
    role: Option<String>,
}

impl Call {
    fn uri(&self) -> String {
        let pairs = self
            .query
            .iter()
            .map(|(name, value)| format!("{name}={}", percent_encoded(value)));
        let query = pairs.collect::<Vec<_>>().join("&");
        format!("{}?{query}", self.path)
    }

    fn request(&self, token: Option<&str>) -> Request<Body> {
        let body = self.body.as_ref().map(Value::to_string).unwrap_or_default();
        request(&self.method.to_ascii_uppercase(), &self.uri(), token, &body)
    }

    /// Returns the call with a member that no route has: in the query string, and in the body.
    fn with_unknown(&self) -> Vec<Self> {
        let mut query = self.clone();
        query.query.push(("hastily_typed".into(), "1".into()));
        let body = self.body.clone().map(|mut body| {
            body["hastily_typed"] = 1.into();
            Self {
                body: Some(body),
                ..self.clone()
            }
        });
        [query].into_iter().chain(body).collect()
    }
}

/// Reads calls from the document.
struct Reader<'a>(&'a Value);

impl Reader<'_> {
    fn followed<'a>(&'a self, schema: &'a Value) -> &'a Value {
        match schema["$ref"].as_str() {
            Some(at) => self.0.pointer(at.trim_start_matches('#')).unwrap(),
            None => schema,
        }
    }

    /// Returns a value of the schema: its example, its first word, or the least value of its type.
    fn value(&self, schema: &Value, whole: bool) -> Value {
        let schema = self.followed(schema);
        let one_of = schema["oneOf"].as_array().into_iter().flatten();
        let mut some = one_of.filter(|it| it["type"] != "null");
        let example = (!schema["example"].is_null()).then(|| schema["example"].clone());
        let words = schema["enum"].as_array().map(|it| it[0].clone());
        let of_type = |name: &str| match name {
            "object" => self.object(schema, whole),
            "string" => json!("text"),
            "integer" | "number" => schema["minimum"].as_i64().unwrap_or(1).into(),
            "boolean" => json!(false),
            "array" => json!([]),
            other => panic!("{other} in {schema}"),
        };
        let kind = schema["type"]
            .as_array()
            .map_or(&schema["type"], |it| &it[0]);
        (example.or(words))
            .or_else(|| some.next().map(|it| self.value(it, whole)))
            .unwrap_or_else(|| of_type(kind.as_str().unwrap_or("object")))
    }

    fn object(&self, schema: &Value, whole: bool) -> Value {
        let required = schema["required"].as_array().cloned().unwrap_or_default();
        let named = schema["properties"].as_object().into_iter().flatten();
        let taken = named.filter(|(name, _)| whole || required.contains(&json!(name)));
        let values = taken.map(|(name, schema)| (name.clone(), self.value(schema, whole)));
        Value::Object(values.collect::<Map<_, _>>())
    }

    /// Returns two calls of every route and kind of body: with the required members only, and with all members.
    fn calls(&self) -> Vec<Call> {
        let paths = self.0["paths"].as_object().unwrap().iter();
        let each = paths.flat_map(|(path, methods)| {
            let methods = methods.as_object().unwrap().iter();
            methods.map(move |(method, operation)| (path, method, operation))
        });
        each.flat_map(|(path, method, operation)| {
            [false, true].map(|whole| self.of(path, method, operation, whole))
        })
        .flatten()
        .collect()
    }

    fn of(&self, path: &str, method: &str, operation: &Value, whole: bool) -> Vec<Call> {
        let (mut path, mut query) = (path.to_owned(), Vec::new());
        for parameter in operation["parameters"].as_array().unwrap() {
            let name = parameter["name"].as_str().unwrap();
            let value = match &parameter["example"] {
                Value::Null => self.value(&parameter["schema"], whole),
                example => example.clone(),
            };
            let value = value
                .as_str()
                .map_or_else(|| value.to_string(), str::to_owned);
            match parameter["in"].as_str().unwrap() {
                "path" => path = path.replace(&format!("{{{name}}}"), &value),
                _ if whole || parameter["required"] == true => query.push((name.to_owned(), value)),
                _ => {}
            }
        }
        let body = &operation["requestBody"]["content"]["application/json"]["schema"];
        let body = self.followed(body);
        let bodies: Vec<&Value> = match body["oneOf"].as_array() {
            Some(variants) => variants.iter().collect(),
            None => vec![body],
        };
        let role = |variant: &Value| {
            let own = variant["x-role"].as_str();
            let role = own.or(operation["security"][0]["session"][0].as_str());
            role.map(str::to_owned)
        };
        let call = |variant: &&Value| Call {
            method: method.to_owned(),
            path: path.clone(),
            query: query.clone(),
            body: (!variant.is_null()).then(|| self.value(variant, whole)),
            role: role(variant),
        };
        bodies.iter().map(call).collect()
    }
}

/// Creates a server whose history has what the examples of the document name.
fn fixture() -> Fixture {
    let fixture = Fixture::new();
    let mut store = Store::open(&fixture.db).unwrap();
    let recipe = std::fs::read_to_string("../../config/recipes/jzc-22f-012.toml").unwrap();
    let at_us = "2026-11-22T08:00:00Z"
        .parse::<jiff::Timestamp>()
        .unwrap()
        .as_microsecond();
    for lot in ["L-1121", "L-1122"] {
        let run = LotRecord {
            lot: lot.into(),
            recipe: "jzc-22f-012".into(),
            recipe_hash: snapshot_hash(&recipe),
            recipe_snapshot: recipe.clone(),
            opened_at_us: at_us,
            ..LotRecord::default()
        };
        store.begin_lot(&run).unwrap();
        let rows = (1..=30).map(|seq| Row::Part(part(lot, seq, at_us)));
        store.record(&rows.collect::<Vec<_>>()).unwrap();
    }
    let alarm = AlarmRecord {
        lot: Some("L-1122".into()),
        code: "door_open".into(),
        raised_at_us: at_us,
        ..AlarmRecord::default()
    };
    let order = OrderRecord {
        at_us,
        who: "li".into(),
        what: json!({"order": "stop"}).to_string(),
        ..OrderRecord::default()
    };
    store
        .record(&[Row::Alarm(alarm), Row::Order(order)])
        .unwrap();
    fixture
}

fn part(lot: &str, seq: u64, at_us: i64) -> PartRecord {
    let values = [
        ("coil_resistance_ohm", 400.0),
        ("operate_voltage_v", 7.9),
        ("release_voltage_v", 2.3),
        ("operate_time_ms", 4.7),
        ("release_time_ms", 2.9),
        ("operate_bounce_ms", 0.4),
        ("release_bounce_ms", 0.5),
        ("contact_resistance_no_mohm", 18.0),
        ("contact_resistance_nc_mohm", 22.0),
    ];
    let measured = |(key, value): (&str, f64)| MeasurementRecord {
        key: key.into(),
        value: Some(value + seq as f64 / 1000.0),
        uncertainty: Some(0.01),
        verdict: "pass".into(),
        attempt: 1,
        ..MeasurementRecord::default()
    };
    PartRecord {
        lot: lot.into(),
        seq,
        // The example of the document; a chart needs several parts.
        serial: Some("L-1122-000017".into()),
        verdict: "pass".into(),
        bin: "pass".into(),
        judged_at_us: at_us + i64::try_from(seq).unwrap() * 1_000_000,
        kind: "lot".into(),
        measurements: values.into_iter().map(measured).collect(),
        ..PartRecord::default()
    }
}

fn percent_encoded(value: &str) -> String {
    let encoded = |byte: u8| match byte.is_ascii_alphanumeric() || b"-_.~".contains(&byte) {
        true => char::from(byte).to_string(),
        false => format!("%{byte:02X}"),
    };
    value.bytes().map(encoded).collect()
}

/// Adds to the call what no document can know: the password, or the hash and a new value of the newest revision.
async fn completed(fixture: &Fixture, mut call: Call) -> Call {
    if call.path == "/api/login" {
        call.body = Some(json!({"user": call.body.unwrap()["user"], "password": PASSWORD}));
    } else if call.path == "/api/recipes/revise" {
        let shown = fixture
            .get("/api/recipes/show?name=jzc-22f-012")
            .await
            .json();
        let body = call.body.as_mut().unwrap();
        body["from"] = shown["hash"].clone();
        let fields = shown["fields"].as_array().unwrap().iter();
        let mut fields = fields.filter(|it| it["path"] == "decision.slow_repeats");
        let repeats = fields.next().unwrap()["value"].as_u64().unwrap() + 1;
        body["values"] = json!({"decision.slow_repeats": repeats});
    }
    call
}

/// Returns true when the document allows the call to a person of this role; `None` means no login.
fn allowed(call: &Call, role: Option<Role>) -> bool {
    let needed = call.role.as_deref().map(|it| it.parse::<Role>().unwrap());
    needed.is_none_or(|needed| role.is_some_and(|role| role >= needed))
}

#[tokio::test]
async fn calls_from_the_document_succeed_in_allowed_roles() {
    let fixture = fixture();
    fixture.willing.store(true, Ordering::SeqCst);
    let document = fixture.get("/api/openapi.json").await.json();
    let calls = Reader(&document).calls();
    assert!(calls.len() > 100, "{}", calls.len());
    let roles = [None].into_iter().chain(Role::ALL.map(Some));
    for (token, role) in askers(&fixture).iter().zip(roles) {
        for call in &calls {
            if APART.contains(&call.path.as_str()) {
                continue;
            }
            let call = completed(&fixture, call.clone()).await;
            let answer = fixture.ask(call.request(token.as_deref())).await;
            let status = match (allowed(&call, role), role) {
                (true, _) => 200,
                (false, None) => 401,
                (false, Some(_)) => 403,
            };
            assert_eq!(
                answer.status,
                status,
                "{role:?} {call:?}: {}",
                answer.text()
            );
        }
    }
}

#[tokio::test]
async fn a_call_with_an_unknown_member_is_refused() {
    let fixture = fixture();
    let document = fixture.get("/api/openapi.json").await.json();
    let [.., engineer] = askers(&fixture);
    for call in Reader(&document).calls() {
        for wrong in completed(&fixture, call).await.with_unknown() {
            let answer = fixture.ask(wrong.request(engineer.as_deref())).await;
            let reason = answer.refused(400);
            let unknown = "hastily_typed: found an unknown member";
            assert!(reason.starts_with(unknown), "{wrong:?}: {reason}");
            assert_eq!(answer.json()["member"], "hastily_typed");
        }
    }
    assert!(!fixture.stopped());
    assert!(fixture.denied.lock().unwrap().is_empty());
}

#[tokio::test]
async fn operations_have_unique_names_summaries_and_schemas() {
    let document = Fixture::new().get("/api/openapi.json").await.json();
    assert!(document["openapi"].as_str().unwrap().starts_with("3.1"));
    let paths = document["paths"].as_object().unwrap().values();
    let operations: Vec<&Value> = paths
        .flat_map(|it| it.as_object().unwrap().values())
        .collect();
    let mut names = std::collections::BTreeSet::new();
    for operation in &operations {
        let name = operation["operationId"].as_str().unwrap();
        assert!(names.insert(name), "{name} twice");
        assert!(!operation["summary"].as_str().unwrap().is_empty(), "{name}");
        let content = operation["responses"]["200"]["content"]
            .as_object()
            .unwrap();
        assert!(
            content.values().all(|it| it["schema"].is_object()),
            "{name}"
        );
        for parameter in operation["parameters"].as_array().unwrap() {
            let about = [
                &parameter["description"],
                &parameter["schema"]["description"],
            ];
            assert!(about.iter().any(|it| it.is_string()), "{name} {parameter}");
        }
    }
    assert_eq!(names.len(), crate::api::routes().len());
    let text = document.to_string();
    for at in text.split("\"$ref\":\"#").skip(1) {
        let at = at.split('"').next().unwrap();
        assert!(document.pointer(at).is_some(), "{at} is missing");
    }
}
