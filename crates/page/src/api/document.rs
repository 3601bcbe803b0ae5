//! The OpenAPI document of a list of routes.

use super::{Member, Method, Route};
use utoipa::openapi::content::ContentBuilder;
use utoipa::openapi::path::{
    HttpMethod, OperationBuilder, ParameterBuilder, ParameterIn, PathItem,
};
use utoipa::openapi::request_body::RequestBodyBuilder;
use utoipa::openapi::schema::{ObjectBuilder, SchemaType, Type};
use utoipa::openapi::{Components, Info, OpenApiBuilder, Paths, Required, ResponseBuilder, Schema};

/// Refusals of every route: status and meaning.
const REFUSALS: [(&str, &str); 4] = [
    ("400", "The request is malformed; the reason says why."),
    ("404", "There is no such thing."),
    ("413", "The body is larger than 16 kB."),
    ("500", "The program failed; the reason says at what."),
];
/// Further refusals of a route that changes something.
const OF_ORDERS: [(&str, &str); 4] = [
    (
        "401",
        "The request has no valid session, or the password is wrong.",
    ),
    (
        "403",
        "The role is too weak, or the request comes from another site.",
    ),
    ("409", "Refused now; `reason` and `reason_zh` say why."),
    (
        "429",
        "Too many wrong passwords; `Retry-After` gives the wait in seconds.",
    ),
];

/// Returns the document as JSON; empty if serialising fails, which a test excludes.
pub(super) fn of(routes: &[Route]) -> serde_json::Value {
    let mut paths = Paths::new();
    for route in routes {
        let method = match route.method {
            Method::Get => HttpMethod::Get,
            Method::Post => HttpMethod::Post,
        };
        let item = PathItem::new(method, operation(route));
        paths.paths.insert(route.path.to_owned(), item);
    }
    let mut components = Components::new();
    let refusal = object(&[
        super::must("error", "The status in a word."),
        super::must("reason", "The reason as a sentence, English."),
        super::may("reason_zh", "The same in Chinese."),
        super::may("code", "The same as a code, where it has one."),
    ]);
    components.schemas.insert("Refusal".into(), refusal.into());
    let document = OpenApiBuilder::new()
        .info(Info::new("relayrig", env!("CARGO_PKG_VERSION")))
        .paths(paths)
        .components(Some(components))
        .build();
    serde_json::to_value(document).unwrap_or_default()
}

fn operation(route: &Route) -> OperationBuilder {
    let (words, answer) = (route.about, ContentBuilder::new().build());
    let done = ResponseBuilder::new()
        .description("Done.")
        .content(route.gives, answer);
    let mut operation = OperationBuilder::new()
        .summary(Some(words))
        .response("200", done);
    if let Some(role) = route.role {
        operation = operation.description(Some(format!("Needs at least the role {role}.")));
    }
    let more: &[_] = match route.method {
        Method::Get => &[],
        Method::Post => &OF_ORDERS,
    };
    for (status, meaning) in REFUSALS.iter().chain(more) {
        operation = operation.response(*status, ResponseBuilder::new().description(*meaning));
    }
    match route.method {
        Method::Get => route.members.iter().fold(operation, |it, member| {
            it.parameter(parameter(route.path, member))
        }),
        Method::Post => {
            let body = ContentBuilder::new().schema(Some(object(&route.members)));
            let body = RequestBodyBuilder::new().content(super::JSON, body.build());
            operation.request_body(Some(body.build()))
        }
    }
}

fn parameter(path: &str, member: &Member) -> ParameterBuilder {
    let in_path = path.contains(&format!("{{{}}}", member.name));
    let place = [ParameterIn::Query, ParameterIn::Path][usize::from(in_path)].clone();
    ParameterBuilder::new()
        .name(member.name)
        .parameter_in(place)
        .required(match member.required {
            true => Required::True,
            false => Required::False,
        })
        .description(Some(member.about))
        .schema(Some(text(member)))
}

fn object(members: &[Member]) -> Schema {
    let object = members.iter().fold(ObjectBuilder::new(), |object, member| {
        let object = object.property(member.name, text(member));
        if member.required {
            object.required(member.name)
        } else {
            object
        }
    });
    Schema::Object(object.build())
}

fn text(member: &Member) -> Schema {
    let kind = match member.name {
        "run" | "seq" | "limit" | "offset" | "last" | "subgroup" | "minutes" | "revision"
        | "count" => Type::Integer,
        "values" => Type::Object,
        "changed" => Type::Boolean,
        "min" | "max" | "ideal_cycle_s" => Type::Number,
        _other => Type::String,
    };
    let text = ObjectBuilder::new().schema_type(SchemaType::new(kind));
    Schema::Object(text.description(Some(member.about)).build())
}
