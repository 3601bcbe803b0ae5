//! Keys of `recipes/NAME.toml`: those that every recipe has, and the sections that its kind describes.

use machine::dut::Kind;
use machine::form::{Form, Key, key, whole};

const DECISION: &[Key] = keys! {
    key("rule", Form::Choice(&["guard_band", "simple"]), "gauge", "limits moved inwards by U (k = 2), or the bare value");
    key("slow_repeats", whole(1, 100, ""), "station", "confirmation measurements of a result inside the guard band");
};

/// Returns the keys that a recipe of this kind may have.
pub fn of(kind: Kind) -> [Key; 8] {
    let place = kind as usize;
    let sections = kind.sections();
    *keys! {
        key("name", Form::Text, "history", "equal to the name of the file");
        key("kind", Form::Choice(&Kind::NAMES[place..=place]), "station", "kind of part");
        key("title_en", Form::Text, "report, hmi", "title in English");
        key("title_zh", Form::Text, "report, hmi", "title in Chinese");
        key("part", Form::Table(sections.part), "guard, gauge", "the part itself");
        key("limits", Form::Table(sections.limits), "gauge", "limits, inclusive; a missing side is not judged");
        key("decision", Form::Table(DECISION), "gauge, station", "how results become verdicts");
        key("test", Form::Table(sections.test), "station", "how the part is measured");
    }
}
