//! Scripted lots with a journal: this program plays a script (`relayrig story`) and records when each output of the rig
//! changed.

use super::order::{Order, finished};
use anyhow::Context;
use serde::Deserialize;
use std::path::Path;

/// An entry of the journal, as `story --journal` writes it.
#[derive(Debug, Clone, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Entry {
    /// The digital outputs of a module have changed.
    Output {
        /// Rig time, microseconds.
        t_us: u64,
        /// Name of the module.
        module: String,
        /// States of the outputs: bit n is channel n, 1 is on.
        bits: u16,
    },
    /// A fault of the script has begun.
    Struck {
        /// Rig time, microseconds.
        t_us: u64,
        /// Fault as the script writes it.
        fault: String,
    },
    /// Another entry, which the studies do not use.
    #[serde(other)]
    Other,
}

/// Result of a story.
#[derive(Debug)]
pub struct Played {
    /// Standard output of the story.
    pub text: String,
    /// Entries of the journal, in order of time.
    pub entries: Vec<Entry>,
    /// Whether the story came to the end of its script.
    pub completed: bool,
}

/// Plays a script with `relayrig story`; its files go to `folder`.
///
/// # Errors
/// Fails when this program refuses the story, or when the journal cannot be read.
pub fn play(order: &Order, folder: &Path, script: &str, seed: u64) -> anyhow::Result<Played> {
    let (file, journal) = (folder.join("story.txt"), folder.join("journal.jsonl"));
    std::fs::write(&file, script)?;
    let mut command = order.command(&folder.join("history.db"), "off");
    command
        .arg("story")
        .arg(&file)
        .arg("--journal")
        .arg(&journal);
    command.args(["--recipe", &order.recipe.name, "--seed", &seed.to_string()]);
    let output =
        finished(&mut command, &[0, 1]).with_context(|| format!("the story with seed {seed}"))?;
    let text = std::fs::read_to_string(&journal)?;
    Ok(Played {
        entries: text
            .lines()
            .map(serde_json::from_str)
            .collect::<Result<_, _>>()
            .with_context(|| format!("the journal of the story with seed {seed}"))?,
        text: String::from_utf8_lossy(&output.stdout).into_owned(),
        completed: output.status.success(),
    })
}
