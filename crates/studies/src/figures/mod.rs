//! `relayrig study figures`: runs the plan of the figures, stores the results, writes `figures.md` with its pictures.
//!
//! | file or folder, below that of the documents | holds |
//! |---|---|
//! | `figures/plan.toml` | the runs, in sections, with their explanations for the reader ([`plan`]) |
//! | `figures/results/NAME.jsonl` | circumstances and figures of a run ([`result`]) |
//! | `figures.md` | the document, rendered from plan and results alone ([`page`]) |
//! | `pictures/` | pictures that a study draws, and plots of figures ([`plot`]) |
//!
//! A run that has no result, or only the result of a different command, counts as not run.

mod machine;
mod number;
mod page;
mod plan;
mod plot;
mod result;
mod runner;
#[cfg(test)]
mod tests;

use anyhow::{Context, ensure};
use page::Results;
pub use plan::{Plan, Run};
pub use result::{Row, RunResult, folder};
use std::path::{Path, PathBuf};

/// What to run and to write.
#[derive(Debug, Clone)]
pub struct Order {
    /// Path of this program, which runs the studies.
    pub program: PathBuf,
    /// Folder of the configuration.
    pub config: PathBuf,
    /// Folder of the documents.
    pub docs: PathBuf,
    /// Names of the runs to make; when empty, every run of the plan.
    pub only: Vec<String>,
    /// Whether to write the document from the stored results, without any run.
    pub renders_only: bool,
}

/// Result of [`make`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Done {
    /// Number of runs of the plan.
    pub runs: usize,
    /// Number of runs of the plan that have a result.
    pub with_result: usize,
    /// Number of figures that miss their bar.
    pub missed: usize,
    /// One message for each run that failed and so has no new result.
    pub failures: Vec<String>,
}

/// A document with its drawn pictures.
#[derive(Debug, Clone, PartialEq)]
pub struct Rendered {
    /// Content of `figures.md`.
    pub document: String,
    /// Pictures to write in the folder `pictures`: name and content of each file.
    pub pictures: Vec<(String, String)>,
}

/// Runs the commands of the order one after another, then writes the document. A failed command does not keep the
/// others from running.
///
/// # Errors
/// Fails when the plan or a stored result cannot be read, for an unknown name, and when a file cannot be written.
pub fn make(order: &Order) -> anyhow::Result<Done> {
    let plan = Plan::load(&order.docs)?;
    let mut failures = Vec::new();
    for run in chosen(&plan, order)? {
        eprintln!("{}: {}", run.name, run.command);
        if let Err(error) = runner::run(order, run) {
            failures.push(format!("{}: {error:#}", run.name));
        }
    }
    let results = results(&plan, &order.docs)?;
    write(&order.docs, &rendered(&plan, &results))?;
    Ok(Done {
        runs: plan.runs().count(),
        with_result: results.len(),
        missed: page::missed_rows(&plan, &results).len(),
        failures,
    })
}

/// Renders the plan and the stored results of a folder of documents.
///
/// # Errors
/// Fails when the plan or a stored result cannot be read.
pub fn render(docs: &Path) -> anyhow::Result<Rendered> {
    let plan = Plan::load(docs)?;
    Ok(rendered(&plan, &results(&plan, docs)?))
}

fn rendered(plan: &Plan, results: &Results) -> Rendered {
    Rendered {
        document: page::document(plan, results),
        pictures: page::pictures(plan, results),
    }
}

/// Returns the runs to make; fails when `only` has a name that the plan lacks.
fn chosen<'a>(plan: &'a Plan, order: &Order) -> anyhow::Result<Vec<&'a Run>> {
    let names: Vec<&str> = plan.runs().map(|run| run.name.as_str()).collect();
    for name in &order.only {
        let known = names.contains(&name.as_str());
        ensure!(known, "--only {name}: expected {}", names.join(", "));
    }
    let is_chosen = |run: &&Run| order.only.is_empty() || order.only.contains(&run.name);
    Ok(match order.renders_only {
        true => Vec::new(),
        false => plan.runs().filter(is_chosen).collect(),
    })
}

fn results(plan: &Plan, docs: &Path) -> anyhow::Result<Results> {
    let mut results = Results::new();
    for run in plan.runs() {
        if let Some(result) = RunResult::load(docs, run)? {
            results.insert(run.name.clone(), result);
        }
    }
    Ok(results)
}

fn write(docs: &Path, rendered: &Rendered) -> anyhow::Result<()> {
    let pictures = docs.join("pictures");
    std::fs::create_dir_all(&pictures).with_context(|| pictures.display().to_string())?;
    let document = [("figures.md".into(), &rendered.document)];
    let drawn = rendered
        .pictures
        .iter()
        .map(|(file, svg)| (pictures.join(file), svg));
    let documents = document.map(|(file, text): (PathBuf, _)| (docs.join(file), text));
    for (file, text) in documents.into_iter().chain(drawn) {
        std::fs::write(&file, text).with_context(|| format!("writing {}", file.display()))?;
    }
    Ok(())
}
