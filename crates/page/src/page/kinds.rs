//! What the page has to know of the kinds of device: words of theirs among its own, and as JSON beside them every
//! characteristic with unit and names, and what is said of a finding.

use machine::dut::reason::Code;
use machine::dut::words::Words;
use machine::dut::{Characteristic, Kind};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// `{"characteristics": [{"key", "unit", "en", "zh"}], "findings": {code: {"en", "zh"}}}`.
pub(super) fn json() -> String {
    let characteristics: Vec<Value> = Characteristic::all().map(named).collect();
    let codes = Kind::ALL.into_iter().flat_map(Kind::findings);
    let findings: BTreeMap<&str, Words> = codes.filter_map(said).collect();
    json!({ "characteristics": characteristics, "findings": findings }).to_string()
}

/// The words of the page and of every kind as one JSON object.
pub(super) fn words(page: &'static str) -> String {
    let kinds = Kind::ALL.into_iter().map(Kind::words);
    let entries: Vec<&str> = std::iter::once(page).chain(kinds).map(entries).collect();
    format!("{{\n{}\n}}\n", entries.join(",\n"))
}

/// What stands between the braces of a JSON object.
fn entries(object: &str) -> &str {
    let inside = object.trim().strip_prefix('{');
    let inside = inside.and_then(|it| it.strip_suffix('}'));
    assert!(inside.is_some(), "words are a JSON object");
    inside.unwrap_or_default().trim()
}

fn named(it: Characteristic) -> Value {
    let known = it.definition();
    json!({ "key": known.key, "unit": known.unit, "en": known.name_en, "zh": known.name_zh })
}

fn said(code: Code) -> Option<(&'static str, Words)> {
    Some((code.name(), code.words()?))
}
