//! The OpenAPI document of the table of routes.

use super::{Method, Operation, Route};
use crate::error::Refusal;
use crate::orders;
use serde_json::{Map, Value, json};

/// Meaning of every status with which a route may refuse.
const REFUSALS: [(u16, &str); 11] = [
    (400, "The request is malformed; the reason says why."),
    (
        401,
        "The request has no valid session, or the password is wrong.",
    ),
    (
        403,
        "The role is too weak, or the request comes from another site.",
    ),
    (404, "There is no such thing."),
    (408, "The body is not whole after 10 s."),
    (409, "Refused now; `reason` and `reason_zh` say why."),
    (413, "The body is larger than 16 kB."),
    (415, "The body is not `application/json`."),
    (
        429,
        "Too many wrong passwords; `Retry-After` gives the wait in seconds.",
    ),
    (500, "The program failed; the reason says at what."),
    (
        503,
        "Another program locks the history, or the database does not answer; try again.",
    ),
];

/// Returns the document as JSON.
pub(in super::super) fn of<S>(routes: Vec<Route<S>>) -> Value {
    let mut shared = Operation::default();
    let refusal = shared.schema_of::<Refusal>();
    let mut paths = Map::new();
    for route in routes {
        paths.insert(
            route.path.to_string(),
            json!({route.method.word(): operation(&route)}),
        );
        shared.keep(route.operation.schemas);
    }
    let mut schemas = shared.schemas;
    orders::describe_roles(&mut schemas);
    let refused = json!({"application/json": {"schema": refusal}});
    let refusals = REFUSALS.map(|(status, about)| {
        let response = json!({"description": about, "content": refused});
        (status.to_string(), response)
    });
    json!({
        "openapi": "3.1.0",
        "info": {
            "title": "relayrig",
            "version": env!("CARGO_PKG_VERSION"),
            "description": "Reading needs no login. A member that a route does not take is refused with 400.",
            "license": {"name": env!("CARGO_PKG_LICENSE")},
        },
        "paths": paths,
        "components": {
            "schemas": schemas,
            "responses": Map::from_iter(refusals),
            "securitySchemes": {
                "session": {"type": "apiKey", "in": "cookie", "name": "relayrig_session"},
                "token": {"type": "http", "scheme": "bearer", "description": "`token` of `POST /api/login`."},
            },
        },
    })
}

fn operation<S>(route: &Route<S>) -> Value {
    let it = &route.operation;
    let (media, schema) = &it.answer;
    let mut responses = Map::new();
    let content = json!({*media: {"schema": schema}});
    responses.insert(
        "200".to_owned(),
        json!({"description": "Done.", "content": content}),
    );
    for status in &it.refusals {
        let response = json!({"$ref": format!("#/components/responses/{status}")});
        responses.insert(status.to_string(), response);
    }
    let mut operation = json!({
        "operationId": id(route),
        "summary": route.about,
        "parameters": it.parameters,
        "responses": responses,
        "security": [],
    });
    if let Some(schema) = &it.body {
        let content = json!({"application/json": {"schema": schema}});
        operation["requestBody"] = json!({"required": true, "content": content});
    }
    if let Some(role) = route.role {
        operation["security"] = json!([{"session": [role]}, {"token": [role]}]);
        operation["description"] = format!("Needs at least the role {role}.").into();
    }
    operation
}

/// Returns the method and the words of the path as one name: `getHistoryReportLot`.
fn id<S>(route: &Route<S>) -> String {
    let words = route
        .path
        .trim_start_matches("/api")
        .split(|it: char| !it.is_alphanumeric());
    let mut id = route.method.word().to_owned();
    let root = (route.path == "/").then_some("page");
    for word in words.filter(|it| !it.is_empty()).chain(root) {
        let (first, rest) = word.split_at(1);
        id.push_str(&first.to_ascii_uppercase());
        id.push_str(rest);
    }
    id
}

impl Method {
    fn word(self) -> &'static str {
        match self {
            Self::Get => "get",
            Self::Post => "post",
        }
    }
}
