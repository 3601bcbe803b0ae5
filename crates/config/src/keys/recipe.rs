//! Keys of `recipes/NAME.toml`: those that every recipe has, and the sections that its kind describes.

use machine::dut::Kind;
use machine::form::{Form, Key, key, optional, whole};

const DECISION: &[Key] = keys! {
    key("rule", Form::Choice(&["guard_band", "simple"]), "gauge", "limits moved inwards by U (k = 2), or the bare value");
    key("slow_repeats", whole(1, 100, ""), "station", "confirmation measurements of a result inside the guard band");
};

const CHOICE: &[Key] = keys! {
    key("name", Form::Text, "station", "name in orders and in the record, used once");
    key("text_en", Form::Text, "hmi", "label in English");
    key("text_zh", Form::Text, "hmi", "label in Chinese");
    optional("stops", Form::Flag, "station", "whether the answer stops the lot; default false");
};

/// Keys of `[[prompt]]` in recipes and in `lot.toml`.
pub(super) const PROMPT: &[Key] = keys! {
    key("name", Form::Text, "station", "name in orders and in the record, used once");
    key("when", Form::Choice(&["lot_start", "before_calibration", "after_calibration", "lot_end"]), "station",
        "before the first motion; before a calibration that is due; before the first part; after the last one");
    key("text_en", Form::Text, "hmi", "request in English");
    key("text_zh", Form::Text, "hmi", "request in Chinese");
    optional("picture", Form::Text, "hmi", "PNG, JPEG or SVG file in config/pictures");
    key("choices", Form::List(&Form::Table(CHOICE)), "station", "answers; at least one goes on");
};

/// Returns the keys that a recipe of this kind may have.
pub fn of(kind: Kind) -> Vec<Key> {
    let place = kind as usize;
    let sections = kind.sections();
    let external = optional(
        "external",
        Form::Table(sections.external),
        "history",
        "results that are measured outside of the rig on samples of the lot: a lot is acceptable when it has each of them, all good",
    );
    let before = keys! {
        key("name", Form::Text, "history", "equal to the name of the file");
        key("kind", Form::Choice(&Kind::NAMES[place..=place]), "station", "kind of part");
        key("title_en", Form::Text, "report, hmi", "title in English");
        key("title_zh", Form::Text, "report, hmi", "title in Chinese");
        key("part", Form::Table(sections.part), "guard, gauge", "the part itself");
        key("limits", Form::Table(sections.limits), "gauge", "limits, inclusive; a missing side is not judged");
    };
    let after = keys! {
        key("decision", Form::Table(DECISION), "gauge, station", "how results become verdicts");
        key("test", Form::Table(sections.test), "station", "how the part is measured");
        optional("prompt", Form::List(&Form::Table(PROMPT)), "station", "what a person must answer during a lot; nothing moves meanwhile");
    };
    let external = (!sections.external.is_empty()).then_some(external);
    before
        .iter()
        .copied()
        .chain(external)
        .chain(after.iter().copied())
        .collect()
}
