//! `history plans`: plans for tooling with their steps.

use super::paper::PaperArgs;
use crate::cli::output::{Column, FormatArgs, Output, text};
use anyhow::bail;
use clap::Args;
use history::Archive;
use history::report::plan::started_sheet;
use history::tooling::{PlanEntry, PlanStep, StartedPlan, StepDone};
use serde::Serialize;

/// Greatest number of plans in a list.
const LISTED: u32 = 10_000;

#[derive(Debug, Args)]
pub(super) struct PlansArgs {
    /// Number of a plan; shows the steps of this plan instead of the list
    #[arg(value_name = "PLAN")]
    plan: Option<i64>,
    /// The plan on paper, HTML for A4
    #[arg(long, requires = "plan")]
    page: bool,
    #[command(flatten)]
    paper: PaperArgs,
    #[command(flatten)]
    format: FormatArgs,
}

const COLUMNS: [Column<PlanEntry>; 12] = [
    ("plan", |it| it.plan.to_string()),
    ("started", |it| it.started.local()),
    ("who", |it| it.who.clone()),
    ("role", |it| it.role.clone()),
    ("kind", |it| it.kind.clone()),
    ("scene", |it| it.scene.clone()),
    ("to", |it| text(it.to.as_ref())),
    ("steps", |it| it.steps.to_string()),
    ("done", |it| it.done.to_string()),
    ("ended", |it| text(it.end.as_ref().map(|end| &end.how))),
    ("ended_by", |it| text(it.end.as_ref().map(|end| &end.who))),
    ("why", |it| {
        text(it.end.as_ref().and_then(|end| end.why.as_ref()))
    }),
];

/// A step with the person who did it, and when.
#[derive(Debug, Serialize)]
struct StepRow {
    #[serde(flatten)]
    step: PlanStep,
    done: Option<StepDone>,
}

const STEPS: [Column<StepRow>; 9] = [
    ("step", |it| it.step.step.to_string()),
    ("action", |it| {
        serde_json::json!(it.step.action)
            .as_str()
            .unwrap_or_default()
            .to_owned()
    }),
    ("elements", |it| it.step.elements.join(" ")),
    ("way", |it| {
        let legs = it.step.legs().map(|(way, mm)| format!("{way} {mm} mm"));
        legs.collect::<Vec<_>>().join(", ")
    }),
    ("clearance_mm", |it| text(it.step.clearance_mm)),
    ("tool_side", |it| it.step.tool_side.clone()),
    ("done", |it| {
        text(it.done.as_ref().map(|done| done.at.local()))
    }),
    ("who", |it| text(it.done.as_ref().map(|done| &done.who))),
    ("role", |it| text(it.done.as_ref().map(|done| &done.role))),
];

pub(super) fn run(archive: &Archive, args: &PlansArgs) -> anyhow::Result<()> {
    let Some(number) = args.plan else {
        let plans = archive.plans(LISTED)?;
        return Output::stdout().list(args.format.format(), &plans, &COLUMNS);
    };
    let Some(started) = archive.plan(number)? else {
        bail!("plan: found {number}, expected one that `history plans` lists");
    };
    if args.page {
        return args
            .paper
            .write(&started_sheet(&args.paper.paper(), &started));
    }
    Output::stdout().list(args.format.format(), &rows(started), &STEPS)
}

fn rows(started: StartedPlan) -> Vec<StepRow> {
    let ticks = started.ticks;
    let row = |step: PlanStep| StepRow {
        done: ticks.iter().find(|it| it.step == step.step).cloned(),
        step,
    };
    started.plan.steps.into_iter().map(row).collect()
}
