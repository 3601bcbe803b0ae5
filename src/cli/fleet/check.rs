//! `fleet check`: whether the databases take this history and give the same answers.

use crate::cli::output::Output;
use app::exit::Exit;
use app::order::Files;
use clap::Args;
use config::{FleetSettings, FleetTarget, load_recipe};
use fleet::differential::{Asked, compare};
use fleet::{Reader, Rigs};
use history::{Archive, Filter};
use machine::dut::Recipe;
use std::collections::BTreeSet;
use std::time::Instant;

#[derive(Debug, Args)]
pub(super) struct CheckArgs {
    /// Also ask history and database N random questions, whose answers must agree to the last digit
    #[arg(long, value_name = "N", default_value_t = 0)]
    questions: u32,
    /// Seed of the questions
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
}

pub(super) fn run(
    files: &Files,
    (settings, targets): (&FleetSettings, &[FleetTarget]),
    args: &CheckArgs,
) -> anyhow::Result<Exit> {
    let reports = super::status::reports(files, settings, targets)?;
    let mut out = Output::stdout();
    let mut in_order = true;
    for (report, target) in reports.iter().zip(targets) {
        in_order &= report.faults.is_empty();
        match report.faults.as_slice() {
            [] => out.line(&format!("{}: in order", report.url))?,
            faults => faults
                .iter()
                .try_for_each(|it| out.line(&format!("{}: {it}", report.url)))?,
        }
        if args.questions > 0 && report.faults.is_empty() {
            anyhow::ensure!(
                report.lag_entries == 0,
                "{}: lacks {} rows; run `relayrig fleet push` before the questions",
                report.url,
                report.lag_entries
            );
            in_order &= ask(files, settings, target, args)?;
        }
    }
    Ok(if in_order {
        Exit::Done
    } else {
        Exit::AnswerIsNo
    })
}

/// Asks the questions; returns true when all answers are the same.
fn ask(
    files: &Files,
    settings: &FleetSettings,
    target: &FleetTarget,
    args: &CheckArgs,
) -> anyhow::Result<bool> {
    let rigs = Rigs {
        site: Some(settings.site.clone()),
        rig: Some(settings.rig.clone()),
    };
    let file = Archive::open(&files.db)?;
    let database = Archive::of_server(Box::new(Reader::open(target, &rigs)?));
    let recipes = recipes(files, &file)?;
    let from = Instant::now();
    let Asked {
        questions,
        refused,
        bytes,
        different,
    } = compare((&file, &database), (args.questions, args.seed), &recipes)?;
    let mut out = Output::stdout();
    out.line(&format!(
        "{}: {questions} questions ({refused} refused), {:.1} MB of answers, {} differ, {:.1} s",
        target.url,
        bytes as f64 / 1e6,
        different.len(),
        from.elapsed().as_secs_f64()
    ))?;
    for question in &different {
        out.line(&format!("  {question}"))?;
    }
    Ok(different.is_empty())
}

/// Returns those recipes of the history that the configuration still has, for judging again.
fn recipes(files: &Files, file: &Archive) -> anyhow::Result<Vec<Recipe>> {
    let names: BTreeSet<String> = file
        .lots(&Filter::default())?
        .into_iter()
        .map(|it| it.recipe)
        .collect();
    let known = names
        .iter()
        .filter_map(|name| load_recipe(&files.config, name).ok());
    Ok(known.collect())
}
