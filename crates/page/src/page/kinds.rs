//! Data of the page (`GET /`), as JSON: texts of the pages, every characteristic of a device with its unit and names,
//! and every bin that a kind of device names.

use machine::dut::{Bin, Characteristic, External, Kind};
use serde_json::{Value, json};
use texts::Lang;
use units::Unit;

/// Families of texts that the answer to `GET /` omits: these texts reach the page inside alarms, reasons and refusals,
/// or appear in print only.
const ELSEWHERE: [&str; 33] = [
    "alarm",
    "batch",
    "batch_choice",
    "batch_list",
    "card",
    "cause",
    "characteristic",
    "column",
    "detail",
    "exchange",
    "external",
    "fault",
    "instrument",
    "interruption",
    "member",
    "next",
    "paper",
    "paper_verdict",
    "part_kind",
    "pin",
    "place",
    "plan",
    "promise",
    "reason",
    "refusal",
    "rejection",
    "remark",
    "reply",
    "request",
    "side",
    "step",
    "transaction",
    "wears",
];

/// Returns `{"characteristics": [{"key", "unit", "en", "zh"}], "external": [the same], "bins": [..]}`, the bins from `pass` to `retest`.
pub(super) fn json() -> String {
    let of = |it: Characteristic| named(it.key(), it.unit(), |lang| it.name(lang));
    let outside = |it: External| named(it.key(), it.unit(), |lang| it.name(lang));
    let characteristics: Vec<Value> = Characteristic::all().map(of).collect();
    json!({ "characteristics": characteristics, "external": External::ALL.map(outside), "bins": bins() }).to_string()
}

fn bins() -> Vec<&'static str> {
    let mut bins = vec![Bin::PASS.name()];
    let of_kinds = Kind::ALL.into_iter().flat_map(|it| it.definition().bins);
    for bin in of_kinds.chain([&Bin::RETEST]) {
        if !bins.contains(&bin.name()) {
            bins.push(bin.name());
        }
    }
    bins
}

/// Returns `{id: {"en", "zh"}}` of the families that `shows` selects.
pub(super) fn words(shows: impl Fn(&str) -> bool) -> String {
    let shown = texts::plain().filter(|it| {
        let family = it.id.split_once('-').map(|(family, _)| family);
        family.is_none_or(|family| !ELSEWHERE.contains(&family) && shows(family))
    });
    let words = shown.map(|it| (it.id.to_owned(), json!({ "en": it.en, "zh": it.zh })));
    Value::Object(words.collect()).to_string()
}

fn named(key: &str, unit: Unit, name: impl Fn(Lang) -> &'static str) -> Value {
    let [en, zh] = Lang::ALL.map(name);
    json!({ "key": key, "unit": unit, "en": en, "zh": zh })
}
