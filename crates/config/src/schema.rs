//! JSON schema (draft 2020-12) of a configuration file, made from the tables that loading uses.

use super::keys;
use machine::dut::Kind;
use machine::form::{Form, Key, Range};
use serde_json::{Map, Value, json};

/// Files that have a schema, by name without extension.
pub const FILES: [&str; 9] = [
    "rig",
    "rig-with-rack",
    "golden",
    "rack",
    "recipe",
    "card",
    "fleet",
    "lot",
    "instrument",
];

/// Returns the schema of a file in [`FILES`]; `None` for any other name.
pub fn of_file(name: &str) -> Option<Value> {
    let keys = match name {
        "rig" => keys::rig::FILE,
        "rig-with-rack" => return Some(schema("rig.toml", keys::rig::WITH_RACK)),
        "golden" => keys::golden::FILE,
        "rack" => keys::golden::CERTIFICATE,
        "card" => keys::card::FILE,
        "fleet" => keys::fleet::FILE,
        "lot" => keys::lot::FILE,
        "instrument" => return Some(schema("instruments/NAME.toml", keys::instrument::FILE)),
        "recipe" => {
            return Some(of_kinds(
                "recipes/NAME.toml",
                &Kind::ALL.map(keys::recipe::of),
            ));
        }
        _ => return None,
    };
    Some(schema(&format!("{name}.toml"), keys))
}

/// Returns the schema of a file with these keys.
fn schema(title: &str, keys: &[Key]) -> Value {
    titled(title, table(keys))
}

/// Returns the schema of a file whose keys depend on its `kind`.
fn of_kinds(title: &str, kinds: &[impl AsRef<[Key]>]) -> Value {
    if let [only] = kinds {
        return schema(title, only.as_ref());
    }
    let each: Vec<Value> = kinds.iter().map(|keys| table(keys.as_ref())).collect();
    let names = each
        .iter()
        .filter_map(|it| it.pointer("/properties/kind/enum")?.as_array());
    let names: Vec<&Value> = names.flatten().collect();
    let head = json!({ "kind": { "enum": names } });
    titled(
        title,
        json!({ "type": "object", "properties": head, "required": ["kind"], "oneOf": each }),
    )
}

fn titled(title: &str, mut root: Value) -> Value {
    if let Value::Object(map) = &mut root {
        map.insert(
            "$schema".to_owned(),
            json!("https://json-schema.org/draft/2020-12/schema"),
        );
        map.insert("title".to_owned(), json!(title));
    }
    root
}

fn table(keys: &[Key]) -> Value {
    let properties: Map<String, Value> = keys
        .iter()
        .map(|key| (key.name.to_owned(), described(form(&key.form), key.meaning)))
        .collect();
    let required: Vec<&str> = keys
        .iter()
        .filter(|key| !key.optional)
        .map(|key| key.name)
        .collect();
    json!({ "type": "object", "properties": properties, "required": required, "additionalProperties": false })
}

fn described(mut value: Value, meaning: &str) -> Value {
    if let Value::Object(map) = &mut value {
        map.insert("description".to_owned(), json!(meaning));
    }
    value
}

fn form(form_of: &Form) -> Value {
    match form_of {
        Form::Text => json!({ "type": "string", "minLength": 1 }),
        Form::Choice(words) => json!({ "enum": words }),
        Form::Hex(digits) => {
            json!({ "type": "string", "pattern": format!("^[0-9A-F]{{{digits}}}$") })
        }
        Form::Number(range) => number(range),
        Form::Whole { low, high, .. } => {
            json!({ "type": "integer", "minimum": low, "maximum": high })
        }
        Form::Listed(values) => json!({ "enum": values }),
        Form::Flag => json!({ "type": "boolean" }),
        Form::Numbers(count, range) => {
            json!({ "type": "array", "items": number(range), "minItems": count, "maxItems": count })
        }
        Form::Table(keys) => table(keys),
        Form::Named(entry) => {
            json!({ "type": "object", "additionalProperties": form(entry), "propertyNames": { "pattern": "^[a-z0-9_]+$" } })
        }
        Form::NamedWith(names, entry) => {
            json!({ "type": "object", "additionalProperties": form(entry), "propertyNames": { "pattern": "^[a-z0-9_]+$" }, "required": names })
        }
        Form::Each(names, entry) => {
            let properties: Map<String, Value> = names
                .iter()
                .map(|name| ((*name).to_owned(), form(entry)))
                .collect();
            json!({ "type": "object", "properties": properties, "required": names, "additionalProperties": false })
        }
        Form::Points(points) => {
            let entry = form(points.entry);
            let names = points.names().into_iter();
            let properties: Map<String, Value> =
                names.map(|name| (name.to_owned(), entry.clone())).collect();
            let others = if points.free { entry } else { json!(false) };
            json!({ "type": "object", "properties": properties, "required": points.must, "additionalProperties": others })
        }
        Form::List(entry) => json!({ "type": "array", "items": form(entry) }),
    }
}

fn number(range: &Range) -> Value {
    let low = if range.low_allowed {
        "minimum"
    } else {
        "exclusiveMinimum"
    };
    json!({ "type": "number", low: range.low, "maximum": range.high })
}

#[cfg(test)]
mod tests {
    use super::*;
    use machine::form::key;

    #[test]
    fn the_schema_knows_what_the_check_knows() {
        let schema = schema("rig.toml", keys::rig::FILE);
        let inputs = &schema["properties"]["digital_in"];
        assert_eq!(inputs["required"][0], "emergency_stop_ok");
        assert!(inputs["properties"]["latch"].is_object(), "may be missing");
        assert!(inputs["additionalProperties"].is_object(), "beams");
        let outputs = &schema["properties"]["digital_out"];
        assert_eq!(outputs["additionalProperties"], json!(false));
        assert_eq!(
            schema["properties"]["safety"]["properties"]["estop_reaction_ms"]["exclusiveMinimum"],
            0.0
        );
        let module = &schema["properties"]["module"]["additionalProperties"];
        assert_eq!(
            module["required"],
            json!(["line", "address", "model", "type"])
        );
    }

    #[test]
    fn every_known_file_and_no_other_has_a_schema() {
        assert!(FILES.iter().all(|name| of_file(name).is_some()));
        let recipe = of_file("recipe").map(|it| it.to_string());
        assert!(recipe.is_some_and(|it| it.contains("expected_operate_sd_v")));
        assert_eq!(of_file("sim"), None);
    }

    #[test]
    fn a_file_has_the_keys_of_one_kind() {
        const ONE: Key = key("kind", Form::Choice(&["one"]), "x", "x");
        const OTHER: Key = key("kind", Form::Choice(&["other"]), "x", "x");
        let only = of_kinds("x.toml", &[[ONE]]);
        assert_eq!(only, schema("x.toml", &[ONE]));
        let both = of_kinds(
            "x.toml",
            &[vec![ONE], vec![OTHER, key("more", Form::Flag, "x", "x")]],
        );
        assert_eq!(both["properties"]["kind"]["enum"], json!(["one", "other"]));
        assert_eq!(both["oneOf"][1]["required"], json!(["kind", "more"]));
        assert!(both["title"] == "x.toml" && both["$schema"].is_string());
    }
}
