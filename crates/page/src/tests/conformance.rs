//! Checks every answer of every test against the OpenAPI document: its status, its media type, its schema.

use super::*;
use crate::api;
use axum::http::Method;
use boon::{Compiler, SchemaIndex, Schemas};
use serde_json::{Value, json};
use std::sync::LazyLock;

/// Address under which the validator finds the document.
const AT: &str = "http://rig/openapi.json";

/// The document, with every object closed: a schema must name every member of an answer.
static CLOSED: LazyLock<Value> = LazyLock::new(|| {
    let mut document = api::document();
    let named = document["components"]["schemas"].clone();
    close(&mut document["components"]["schemas"], &named, true);
    for path in document["paths"].as_object_mut().unwrap().values_mut() {
        for operation in path.as_object_mut().unwrap().values_mut() {
            close(&mut operation["responses"]["200"], &named, true);
        }
    }
    document
});

/// Closes objects that name their members. Each part of an `allOf` sees the members of the other parts, so only the
/// whole is closed, and a part that refers to a named schema gets an open copy of that schema.
fn close(schema: &mut Value, named: &Value, whole: bool) {
    match schema {
        Value::Object(members) => {
            let name = members.get("$ref").and_then(Value::as_str);
            if let (Some(name), false) = (name, whole) {
                let name = name.rsplit('/').next().unwrap();
                *schema = named[name].clone();
                return close(schema, named, false);
            }
            for (name, inner) in members.iter_mut() {
                let whole = match name.as_str() {
                    "allOf" => false,
                    "oneOf" | "anyOf" => whole,
                    _ => true,
                };
                close(inner, named, whole);
            }
            let parts = members.contains_key("allOf");
            let names = members.get("properties").is_some_and(Value::is_object);
            if whole && (parts || names) && !members.contains_key("additionalProperties") {
                members.insert("unevaluatedProperties".into(), false.into());
            }
        }
        Value::Array(items) => items.iter_mut().for_each(|it| close(it, named, whole)),
        _ => {}
    }
}

/// Fails unless the document has the status of the answer, its media type, and a schema that its JSON fits.
pub(super) fn check(method: &Method, path: &str, answer: &Answer) {
    let status = answer.status.as_u16();
    let method = method.as_str().to_ascii_lowercase();
    let template = match path.strip_prefix("/page/") {
        Some(_) => "/page/{file}",
        None => path,
    };
    let said = &CLOSED["paths"][template][&method]["responses"];
    if said.is_null() {
        assert!([404, 405].contains(&status), "{method} {path}: {status}");
        return;
    }
    let status_said = &said[status.to_string()];
    assert!(
        !status_said.is_null(),
        "{method} {path}: {status} is not documented: {}",
        answer.text()
    );
    let given = answer.headers["content-type"].to_str().unwrap();
    let media = given.split(';').next().unwrap();
    let at = match status {
        200 => {
            let content = &status_said["content"][media];
            assert!(
                !content.is_null(),
                "{method} {path}: {media} is not documented"
            );
            pointer(&[
                "paths",
                template,
                &method,
                "responses",
                "200",
                "content",
                media,
                "schema",
            ])
        }
        _ => pointer(&["components", "schemas", "Refusal"]),
    };
    if media == "application/json" {
        validate(&at, &answer.json(), &format!("{method} {path} {status}"));
    }
}

fn pointer(names: &[&str]) -> String {
    let escaped = names
        .iter()
        .map(|it| it.replace('~', "~0").replace('/', "~1"));
    escaped.map(|it| format!("/{it}")).collect()
}

/// Fails unless `value` fits the schema at this place of the document.
pub(super) fn validate(at: &str, value: &Value, what: &str) {
    let (mut schemas, mut compiler) = (Schemas::new(), Compiler::new());
    compiler.add_resource(AT, CLOSED.clone()).unwrap();
    let at = at.replace('{', "%7B").replace('}', "%7D");
    let compiled: SchemaIndex = compiler
        .compile(&format!("{AT}#{at}"), &mut schemas)
        .unwrap_or_else(|error| panic!("{what}: {error:#}"));
    if let Err(error) = schemas.validate(value, compiled) {
        panic!("{what}: {error:#}");
    }
}

#[test]
fn a_wrong_answer_does_not_conform() {
    let lots = pointer(&["components", "schemas", "Person"]);
    let wrong = json!({"name": "li", "role": "operator", "age": 7});
    for person in [
        wrong,
        json!({"name": "li"}),
        json!({"name": 7, "role": "operator"}),
    ] {
        let judged = std::panic::catch_unwind(|| validate(&lots, &person, ""));
        assert!(judged.is_err(), "{person}");
    }
    validate(&lots, &json!({"name": "li", "role": "operator"}), "");
}
