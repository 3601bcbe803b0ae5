//! A plan for tooling on paper: a step per row, with pictures from above and from the front, and room to sign.

use super::Paper;
use super::page::{Format, facts, head, page, sign_off};
use super::plan_drawing::{PlanView, picture, shapes};
use crate::tooling::{
    ChangeoverRow, PlanAction, PlanStep, StartedPlan, StepDone, ToolingPlan, element_name,
    side_name,
};
use maud::{Markup, PreEscaped, html};
use texts::Lang;

/// Returns a plan as an HTML page, A4.
pub fn sheet(paper: &Paper, plan: &ToolingPlan) -> String {
    printed(paper, plan, None)
}

/// Returns the page of a plan that was started, with the persons who have done its steps.
pub fn started_sheet(paper: &Paper, started: &StartedPlan) -> String {
    printed(paper, &started.plan, Some(started))
}

fn printed(paper: &Paper, plan: &ToolingPlan, started: Option<&StartedPlan>) -> String {
    let language = paper.language;
    let title = language.text(&format!("tooling_kind-{}", plan.kind.word()));
    let about = match &plan.to {
        Some(to) => format!("{} → {to}", plan.scene),
        None => plan.scene.clone(),
    };
    let body = html! {
        (head(title, &about))
        (facts(&heading(paper, plan, started)))
        @if let Some(summary) = &plan.summary { (groups(language, summary)) }
        (PreEscaped(shapes(plan)))
        p.note { (key(language)) }
        (steps(paper, plan, started.map_or(&[], |it| it.ticks.as_slice())))
        p.remark { (language.text("tooling-safe")) }
        (sign_off(language))
    };
    page(paper, Format::Portrait, title, &body)
}

fn heading(
    paper: &Paper,
    plan: &ToolingPlan,
    started: Option<&StartedPlan>,
) -> Vec<(&'static str, String)> {
    let language = paper.language;
    let mut pairs = vec![(language.text("tooling-steps"), plan.steps.len().to_string())];
    if !plan.remove.is_empty() {
        pairs.push((
            language.text("tooling-remove"),
            names(language, &plan.remove),
        ));
    }
    let Some(started) = started else {
        return pairs;
    };
    let entry = &started.entry;
    pairs.push((language.text("tooling-plan"), entry.plan.to_string()));
    let at = format!("{} {}", paper.time(entry.started), entry.who);
    pairs.push((language.text("tooling-started"), at));
    if let Some(end) = &entry.end {
        let how = language.text(&format!("tooling_end-{}", end.how));
        let why = end.why.as_deref().unwrap_or_default();
        let text = format!("{how} {} {} {why}", paper.time(end.at), end.who);
        pairs.push((language.text("tooling-ended"), text.trim_end().to_owned()));
    }
    pairs
}

fn groups(language: Lang, summary: &ChangeoverRow) -> Markup {
    let groups = [
        ("stays", &summary.stays),
        ("goes", &summary.goes),
        ("comes", &summary.comes),
        ("returns", &summary.returns),
    ];
    html! {
        @for (code, ids) in groups { @if !ids.is_empty() {
            p.note { b { (language.text(&format!("tooling-{code}"))) } " " (names(language, ids)) }
        } }
    }
}

fn key(language: Lang) -> Markup {
    html! {
        span.plan_key.moves {} (language.text("tooling-moves")) " "
        span.plan_key.holds {} (language.text("tooling-holds")) " "
        span.plan_key.stands {} (language.text("tooling-stands"))
    }
}

fn steps(paper: &Paper, plan: &ToolingPlan, ticks: &[StepDone]) -> Markup {
    let language = paper.language;
    let say = |id| language.text(id);
    html! {
        table.plan {
            thead { tr {
                th.n { (say("paper-number")) } th { (say("tooling-step")) }
                th { (say("tooling-above")) } th { (say("tooling-front")) } th { (say("tooling-done")) }
            } }
            tbody { @for (place, step) in plan.steps.iter().enumerate() { tr {
                td.n { (step.step) }
                td.text { (said(language, step)) }
                @for (view, id) in PlanView::BOTH.into_iter().zip(["tooling-above", "tooling-front"]) {
                    td.view { (PreEscaped(picture(plan, place, view, say(id)))) }
                }
                td.tick { @match ticks.iter().find(|it| it.step == step.step) {
                    Some(tick) => { "☑ " (tick.who) br; (paper.time(tick.at)) }
                    None => "☐",
                } }
            } } }
        }
    }
}

/// Returns the instructions of a step, as short lines.
fn said(language: Lang, step: &PlanStep) -> Markup {
    let say = |id| language.text(id);
    let legs = step.legs();
    let legs = legs.map(|(way, mm)| format!("{} {mm} mm", side_name(language, way)));
    let legs: Vec<String> = legs.collect();
    html! {
        b { (say(action(step))) } " " b { (names(language, &step.elements)) }
        @if step.on_bench { br; (say("tooling-on_bench")) }
        br; (say("tooling-way")) " " (legs.join(language.comma()))
        br; (say("tooling-clearance")) " " (step.clearance(language))
        @if !step.slides_on.is_empty() { br; (say("tooling-slides")) " " (names(language, &step.slides_on)) }
        br; (say("tooling-tool")) " " (side_name(language, &step.tool_side))
    }
}

fn action(step: &PlanStep) -> &'static str {
    match step.action {
        PlanAction::Remove => "tooling-take_off",
        PlanAction::Add => "tooling-put_on",
    }
}

fn names(language: Lang, ids: &[String]) -> String {
    let names: Vec<String> = ids.iter().map(|id| element_name(language, id)).collect();
    names.join(language.comma())
}
