//! The operation process card of a recipe: steps with tooling, drive, limits and time quota. The form is the one that
//! is usual for machining, with drive, limits and decision in place of spindle and feed.
//!
//! The kind of device gives steps, rating and drive ([`Card`]), the recipe gives the limits, and `card.toml` gives what
//! only the plant knows ([`CardSettings`]).

use super::Paper;
use super::lot::limits;
use super::page::{Format, page};
use super::words::{figure, parameter, short_hash};
use machine::dut::card::{Card, CardSettings, Demand, Piece, Step};
use machine::dut::{Characteristic, Recipe};
use machine::gauge::Rule;
use maud::{Markup, html};
use quality::Limits;
use texts::Lang;

/// Returns the card as an HTML page, A4 landscape.
pub fn card(paper: &Paper, recipe: &Recipe, plant: &CardSettings) -> String {
    let language = paper.language;
    let title = language.text("paper-operation_process_card");
    let kind = recipe.device.card();
    let body = html! {
        (header(language, recipe, &kind, plant))
        (steps(language, recipe, &kind, plant))
        p.note { (remarks(language, recipe, &kind)) }
        p.remark { (language.text("paper-not_tested")) }
        (signatures(language))
    };
    page(paper, Format::Landscape, title, &body)
}

fn header(language: Lang, recipe: &Recipe, kind: &Card, plant: &CardSettings) -> Markup {
    let say = |id| language.text(id);
    let ((rating, rated), quota) = (&kind.rating, total(plant));
    let part = recipe.device.part();
    let [x, y, z] = part.body_mm;
    html! {
        table.card {
            tr {
                th.title colspan="4" rowspan="2" { (say("paper-operation_process_card")) }
                th { (say("paper-product_type")) } td { (recipe.name) }
                th { (say("paper-drawing_no")) } td {}
            }
            tr {
                th { (say("paper-product")) } td { (title(language, recipe)) }
                th { (say("paper-page")) } td { (say("paper-page_count")) }
            }
            tr {
                th { (say("paper-workshop")) } th { (say("paper-operation_no")) }
                th colspan="2" { (say("paper-operation")) }
                th { (language.text(rating)) } th { (say("paper-body_mm")) }
                th { (say("paper-pin_length_mm")) } th { (say("paper-reference_temperature")) }
            }
            tr {
                td { (plant.workshop) } td { (plant.operation_no) }
                td colspan="2" { (say("paper-operation_name")) }
                td { (joined(language, rated)) }
                td { (figure(Some(x))) " × " (figure(Some(y))) " × " (figure(Some(z))) }
                td { (figure(Some(part.pin_length_mm))) } td { (figure(Some(part.reference.0))) " °C" }
            }
            tr {
                th { (say("paper-equipment")) } th { (say("paper-equipment_type")) }
                th { (say("paper-equipment_no")) } th { (say("paper-parts_at_once")) }
                th { (say("paper-fixture")) } th { (say("paper-fixture_no")) }
                th { (say("paper-preparation_min")) } th { (say("paper-per_part_s")) }
            }
            tr {
                td { (say("paper-equipment_name")) } td { (plant.equipment_model) }
                td { (plant.equipment_no) } td { (plant.pieces_at_once) }
                td { (say("paper-fixture_name")) } td { (plant.fixture_no) }
                td { (figure(Some(plant.preparation_min))) } td { (format!("{quota:.2}")) }
            }
        }
    }
}

fn title(language: Lang, recipe: &Recipe) -> &str {
    match language {
        Lang::En => &recipe.title_en,
        Lang::Zh => &recipe.title_zh,
    }
}

/// Returns the sum of all time quotas, seconds.
fn total(plant: &CardSettings) -> f64 {
    plant
        .quota
        .values()
        .map(|it| it.machine_s + it.auxiliary_s)
        .sum()
}

fn steps(language: Lang, recipe: &Recipe, kind: &Card, plant: &CardSettings) -> Markup {
    let say = |id| language.text(id);
    html! {
        table.card {
            thead {
                tr {
                    th rowspan="2" { (say("paper-step_no")) }
                    th rowspan="2" { (say("paper-step")) }
                    th rowspan="2" { (say("paper-tooling")) }
                    th rowspan="2" { (say("paper-drive")) }
                    th rowspan="2" { (say("paper-requirement")) }
                    th colspan="2" { (say("paper-time_quota_s")) }
                }
                tr { th { (say("paper-machine")) } th { (say("paper-auxiliary")) } }
            }
            tbody {
                @for (number, step) in (1..).zip(&kind.steps) {
                    @let quota = plant.quota.get(step.name).copied().unwrap_or_default();
                    tr {
                        td { (number) } td.text { (language.attribute(step.text, "what")) }
                        td.text { (language.attribute(step.text, "tooling")) }
                        td.text { (joined(language, &step.drive)) }
                        td.text { (required_value(language, recipe, step)) }
                        td { (format!("{:.2}", quota.machine_s)) } td { (format!("{:.2}", quota.auxiliary_s)) }
                    }
                }
            }
        }
    }
}

fn joined(language: Lang, pieces: &[Piece]) -> String {
    let one = |piece: &Piece| match piece {
        Piece::Figure(value) => figure(Some(*value)),
        Piece::Literal(text) => text.replace(", ", language.comma()),
        Piece::Text(id) => language.text(id).to_owned(),
    };
    pieces.iter().map(one).collect()
}

fn required_value(language: Lang, recipe: &Recipe, step: &Step) -> String {
    match &step.demand {
        Demand::Sensors => language.attribute(step.text, "requirement").to_owned(),
        Demand::Within(characteristics) => demands(language, recipe, characteristics),
    }
}

fn demands(language: Lang, recipe: &Recipe, characteristics: &[Characteristic]) -> String {
    let one = |characteristic: &Characteristic| {
        let limit = recipe.limits.of(*characteristic);
        let name = parameter(language, characteristic.key());
        let (low, high) = (limit.low, limit.high);
        let is_limited = low.is_some() || high.is_some();
        is_limited.then(|| format!("{name} {}", limits(Limits { low, high })))
    };
    let all: Vec<String> = characteristics.iter().filter_map(one).collect();
    all.join(language.semicolon())
}

fn remarks(language: Lang, recipe: &Recipe, kind: &Card) -> String {
    let decision = &recipe.decision;
    let rule = match decision.rule {
        Rule::GuardBand => language.text("paper-decision_guard_band"),
        Rule::Simple => language.text("paper-decision_simple"),
    };
    let (repeats, mark) = (language.text("paper-confirmations"), language.semicolon());
    let counts = kind.counts.iter();
    let counts: String = counts
        .map(|(words, count)| format!("{mark}{} {count}", language.text(words)))
        .collect();
    let recipe_text = language.text("paper-card_recipe_sha_256");
    format!(
        "{rule}{mark}{repeats} {}{counts}{mark}{recipe_text} {}",
        decision.slow_repeats,
        short_hash(&recipe.hash)
    )
}

fn signatures(language: Lang) -> Markup {
    let say = |id| language.text(id);
    let change = [
        say("paper-mark"),
        say("paper-places"),
        say("paper-change_note_no"),
        say("paper-signature"),
        say("paper-date"),
    ];
    html! {
        table.card.sign {
            tr {
                @for name in change { th { (name) } }
                th { (say("paper-drawn_up_date")) }
                th { (say("paper-checked_date")) }
                th { (say("paper-countersigned_date")) }
            }
            tr.blank { @for _ in 0..8 { td {} } }
            tr.blank { @for _ in 0..8 { td {} } }
        }
    }
}
