//! `study figures`: runs the plan of the figures and writes the document.

use anyhow::{Context, bail};
use app::exit::Exit;
use std::path::{Path, PathBuf};
use studies::figures::{Done, Order, make};

/// Arguments of `study figures`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Examples:
  relayrig study figures
  relayrig study figures --only cycle --only stop
  relayrig study figures --render

Exit status: 0 every run has a result that keeps its bars, 1 a result is missing or misses a bar, 2 a run failed.")]
pub struct FiguresArgs {
    /// Only this run of the plan; repeatable
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,
    /// Write the document from the stored results, without a run
    #[arg(long, conflicts_with = "only")]
    render: bool,
    /// Folder of the documents, with figures/plan.toml
    #[arg(long, value_name = "DIR", default_value = "docs")]
    docs: PathBuf,
}

/// Runs `relayrig study figures`.
///
/// # Errors
/// Fails when plan or results cannot be read, when a run failed, or when a file cannot be written.
pub fn run(config: &Path, args: &FiguresArgs) -> anyhow::Result<Exit> {
    let done = make(&Order {
        program: std::env::current_exe().context("finding this program")?,
        config: config.to_owned(),
        docs: args.docs.clone(),
        only: args.only.clone(),
        renders_only: args.render,
    })?;
    super::print(&said(&done, &args.docs))?;
    if !done.failures.is_empty() {
        bail!("{}", done.failures.join("\n"));
    }
    Ok(match (done.with_result == done.runs, done.missed) {
        (true, 0) => Exit::Done,
        (_, _) => Exit::AnswerIsNo,
    })
}

fn said(done: &Done, docs: &Path) -> String {
    format!(
        "{}: {} of {} runs have a result, {} bars missed\n",
        docs.join("figures.md").display(),
        done.with_result,
        done.runs,
        done.missed
    )
}
