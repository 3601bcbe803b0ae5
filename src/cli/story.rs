//! `relayrig story`: a script of troubles and orders on the simulated rig, and what happened, line by line.
//!
//! A script ([`script`]) says which faults strike the rig and what a person at the screen does, each after an event,
//! not at a time: so it tells the same story on a faster line. What is seen is told as a mechanic who stood
//! beside it would ([`told`]). Seconds count from the first trouble, in whole ones, and only of what has to do with it.
//!
//! A person is at the screen: alarms and stops end nothing. The story ends when the script has been played and the
//! lot is complete, or when nothing has happened for [`play::PATIENCE`].
//!
//! Exit status: 0 the script was played and the lot completed, 1 something in it never came.

mod play;
mod script;
mod told;

use super::rig::{PaceArg, RigArgs};
use super::run::{self, Controls, Orders, RunArgs};
use anyhow::Context;
pub use play::Play;
use std::fs::File;
use std::path::{Path, PathBuf};

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

Exit status: 0 played and the lot complete, 1 something never came, 2 bad input.")]
pub struct StoryArgs {
    /// The script
    #[arg(value_name = "FILE")]
    pub script: PathBuf,
    /// Draws rig and parts
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Recipe in config/recipes
    #[arg(long, value_name = "NAME", default_value = "jzc-22f-012")]
    pub recipe: String,
    /// True values of every specimen go to this file
    #[arg(long, value_name = "FILE")]
    pub truth: Option<PathBuf>,
    /// Every fault of the script and every change of a digital output go to this file, one object per line
    #[arg(long, value_name = "FILE")]
    pub journal: Option<PathBuf>,
}

/// Runs the command; the result is the exit status.
///
/// # Errors
/// Bad input.
pub fn run(config: &Path, db: &Path, args: &StoryArgs) -> anyhow::Result<i32> {
    let named = || args.script.display().to_string();
    let text = std::fs::read_to_string(&args.script).with_context(named)?;
    let script = script::parse(&text).with_context(named)?;
    let journal = args.journal.as_deref().map(created).transpose()?;
    let lot = args.script.file_stem().unwrap_or_default();
    let order = RunArgs {
        rig: RigArgs {
            sim: true,
            pace: PaceArg::Virtual,
            speed: None,
            seed: args.seed,
            world: None,
            fault: script.faults.clone(),
            line: Vec::new(),
        },
        lot: format!("story {}", lot.to_string_lossy()),
        recipe: args.recipe.clone(),
        count: Some(script.parts),
        retest: None,
        truth: args.truth.clone(),
        json: false,
        study: None,
    };
    let controls = Controls {
        stays: true,
        ..Controls::new(true)
    };
    run::run_with(
        config,
        db,
        &order,
        &controls,
        Orders::Script(Play::new(script, journal)),
    )
}

fn created(journal: &Path) -> anyhow::Result<File> {
    File::create(journal).with_context(|| format!("--journal {}", journal.display()))
}
