//! `relayrig story`: plays a script of troubles and orders on the simulated rig and prints the events, line by line.
//!
//! Exit status: 0 the script was played and the lot completed, 1 an event of the script did not come.

use super::terminal::Terminal;
use anyhow::Context;
use app::exit::Exit;
use app::order::{Files, LotOrder};
use app::source::Simulated;
use app::story::{self, script};
use app::truth_file::TruthFile;
use std::fs::File;
use std::io::Write;
use std::path::PathBuf;

/// A script to play.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  relayrig story tests/line/stories/door.txt
  relayrig --db /tmp/story.db story my.txt --seed 7 --truth truth.jsonl

A script: the first comment is its title, then
  parts 4                               parts of the lot
  fault jam_pusher=3                    from the start, see `relayrig sim --faults`
  after judged 2 +0.5 fault door        then one after the other: after an event (+ seconds), a fault
  after state Aborted +5 order clear    or an order, as a person at a screen gives it
Events: lot, state NAME, alarm CODE, judged N, left N, landed N. The last line is followed by the end of the lot.

Exit status: 0 played and the lot complete, 1 an event did not come, 2 bad input.")]
pub struct StoryArgs {
    /// The script
    #[arg(value_name = "FILE")]
    pub script: PathBuf,
    /// Seed of rig and parts
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Recipe in config/recipes
    #[arg(long, value_name = "NAME", default_value = "jzc-22f-012")]
    pub recipe: String,
    /// Write the true values of every part into this file
    #[arg(long, value_name = "FILE")]
    pub truth: Option<PathBuf>,
    /// Write the journal of the rig (changes of outputs, faults, expired host watchdogs), one JSON object per line
    #[arg(long, value_name = "FILE")]
    pub journal: Option<PathBuf>,
}

/// Runs `relayrig story`.
///
/// # Errors
/// Fails on bad input, such as a script with an unknown word.
pub fn run(files: &Files, args: &StoryArgs) -> anyhow::Result<Exit> {
    let named = || args.script.display().to_string();
    let text = std::fs::read_to_string(&args.script).with_context(named)?;
    let script = script::parse(&text).with_context(named)?;
    let journal = args
        .journal
        .as_ref()
        .map(|path| File::create(path).with_context(|| format!("--journal {}", path.display())));
    let journal = journal.transpose()?;
    if let Some(path) = &args.truth {
        TruthFile::create(path)?;
    }
    let lot = args.script.file_stem().unwrap_or_default();
    // A complete lot takes no second run, so each play of a script has a lot of its own.
    let now = jiff::Zoned::now().strftime("%Y-%m-%d %H:%M:%S%.6f");
    let order = LotOrder {
        lot: format!("story {} {now}", lot.to_string_lossy()),
        recipe: args.recipe.clone(),
        count: Some(script.parts),
        retest: None,
    };
    let rig = Simulated {
        faults: script.faults.clone(),
        truth: args.truth.clone(),
        ..Simulated::with_seed(args.seed)
    };
    let (report, exit) = story::run(
        files,
        rig,
        &order,
        (script, journal),
        &mut Terminal::quiet(),
    )?;
    if let Some(report) = report {
        // A closed pipe is no error.
        std::io::stdout().write_all(report.text.as_bytes()).ok();
    }
    Ok(exit)
}
