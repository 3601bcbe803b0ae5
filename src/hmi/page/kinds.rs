//! What the page has to know of the kinds of device, as JSON beside its words: every characteristic with unit and names, and
//! what is said of a finding.

use crate::dut::reason::Code;
use crate::dut::words::Words;
use crate::dut::{Characteristic, Kind};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// `{"characteristics": [{"key", "unit", "en", "zh"}], "findings": {code: {"en", "zh"}}}`.
pub(super) fn json() -> String {
    let characteristics: Vec<Value> = Characteristic::all().map(named).collect();
    let codes = Kind::ALL.into_iter().flat_map(Kind::findings);
    let findings: BTreeMap<&str, Words> = codes.filter_map(said).collect();
    json!({ "characteristics": characteristics, "findings": findings }).to_string()
}

fn named(it: Characteristic) -> Value {
    let known = it.definition();
    json!({ "key": known.key, "unit": known.unit, "en": known.name_en, "zh": known.name_zh })
}

fn said(code: Code) -> Option<(&'static str, Words)> {
    Some((code.name(), code.words()?))
}
