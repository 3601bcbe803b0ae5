//! Stories with a journal: a script is played by this very program, and what the outputs did is read back.

use super::fleet::Order;
use anyhow::{Context, bail};
use serde::Deserialize;
use std::path::Path;
use std::process::{Command, Stdio};

/// An entry of the journal.
#[derive(Debug, Clone, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Entry {
    /// The digital outputs of a module have changed.
    Output {
        /// Rig time, microseconds.
        t_us: u64,
        /// Name of the module.
        module: String,
        /// Bit n = channel n.
        bits: u16,
    },
    /// A fault of the script has struck.
    Struck {
        /// Rig time, microseconds.
        t_us: u64,
        /// Fault as the script writes it.
        fault: String,
    },
    /// A host watchdog has expired; the studies do not use it.
    Expired {},
}

/// A story that was played.
#[derive(Debug)]
pub struct Played {
    /// Text of the story.
    pub text: String,
    /// Entries of the journal, in order of time.
    pub entries: Vec<Entry>,
    /// The script was played to its end.
    pub whole: bool,
}

/// Plays a script; its files go to `folder`.
///
/// # Errors
/// A story that could not be played, or a journal that could not be read.
pub fn play(order: &Order, folder: &Path, script: &str, seed: u64) -> anyhow::Result<Played> {
    let told = || format!("the story with seed {seed}");
    let (file, journal) = (folder.join("story.txt"), folder.join("journal.jsonl"));
    std::fs::write(&file, script).with_context(told)?;
    let mut command = Command::new(&order.program);
    command.arg("--config").arg(&order.config);
    command.arg("--db").arg(folder.join("history.db"));
    command.args(["--log", "off", "story"]).arg(&file);
    command.args(["--recipe", &order.recipe, "--seed", &seed.to_string()]);
    command.arg("--journal").arg(&journal);
    let output = command.stdin(Stdio::null()).output().with_context(told)?;
    let status = output.status.code();
    if !matches!(status, Some(0 | 1)) {
        bail!(
            "{}: {}",
            told(),
            String::from_utf8_lossy(&output.stderr).trim()
        );
    }
    let text = std::fs::read_to_string(&journal).with_context(told)?;
    let entries = text.lines().map(serde_json::from_str);
    Ok(Played {
        entries: entries.collect::<Result<_, _>>().with_context(told)?,
        text: String::from_utf8_lossy(&output.stdout).into_owned(),
        whole: status == Some(0),
    })
}
