//! The result of a run as lines of JSON: first its circumstances, then the figures that it printed.

use super::plan::Run;
use crate::figure::Bar;
use anyhow::{Context, ensure};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Keys that every figure has; any other key is a further column.
const FIXED: [&str; 8] = [
    "type", "study", "figure", "n", "value", "unit", "bar", "met",
];

/// Circumstances of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Head {
    /// Command, as in the plan.
    pub command: String,
    /// Day of the run, UTC.
    pub date: String,
    /// Commit of the working folder; `None` outside of a repository.
    pub commit: Option<String>,
    /// Whether the working folder differed from the commit, figures and pictures aside.
    pub is_changed: bool,
    /// Name of the processor.
    pub cpu: String,
    /// Number of threads that the processor runs simultaneously.
    pub cores: usize,
    /// Number of cores that other programs kept busy just before the run; `None` where the system does not say.
    pub busy_cores: Option<f64>,
    /// Wall time of the run, seconds.
    pub seconds: f64,
}

/// A figure as a run printed it.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Name.
    pub figure: String,
    /// Number of parts, lots or runs behind the value.
    pub n: u64,
    /// The value; `None` when nothing was measured.
    pub value: Option<f64>,
    /// Unit of the value.
    pub unit: String,
    /// Bar of the value.
    pub bar: Option<Bar>,
    /// Further columns by name.
    pub columns: BTreeMap<String, Option<f64>>,
}

/// The result of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct RunResult {
    /// Circumstances.
    pub head: Head,
    /// Figures, in the order in which the run printed them.
    pub rows: Vec<Row>,
}

impl Row {
    /// Returns whether the value misses its bar; a missing value misses any bar.
    pub fn is_missed(&self) -> bool {
        let is_kept = |bar: Bar| self.value.is_some_and(|value| bar.is_met(value));
        self.bar.is_some_and(|bar| !is_kept(bar))
    }

    fn read(line: &Value) -> anyhow::Result<Self> {
        let text = |key: &str| {
            let found = line[key].as_str().map(str::to_owned);
            found.with_context(|| format!("{key}: found {}, expected a text", line[key]))
        };
        let bar = match &line["bar"] {
            Value::Null => None,
            bar => {
                let read = bar.as_str().and_then(Bar::read);
                Some(read.with_context(|| format!("bar: found {bar}, expected \"<= 1\""))?)
            }
        };
        let columns = line.as_object().into_iter().flatten();
        let columns = columns
            .filter(|(key, value)| {
                !FIXED.contains(&key.as_str()) && (value.is_number() || value.is_null())
            })
            .map(|(key, value)| (key.clone(), value.as_f64()));
        Ok(Self {
            figure: text("figure")?,
            n: line["n"]
                .as_u64()
                .with_context(|| format!("n: found {}, expected a count", line["n"]))?,
            value: line["value"].as_f64(),
            unit: text("unit")?,
            bar,
            columns: columns.collect(),
        })
    }
}

/// Reads the figures among the lines that a run printed.
///
/// # Errors
/// Fails for a line that is no JSON, for a figure that lacks a key, and when there is no figure.
pub fn rows(printed: &str) -> anyhow::Result<Vec<Row>> {
    let mut rows = Vec::new();
    for (number, line) in (1..).zip(printed.lines()) {
        let place = || format!("printed line {number}: {line:?}");
        let object: Value = serde_json::from_str(line).with_context(place)?;
        if object["type"] == "figure" {
            rows.push(Row::read(&object).with_context(place)?);
        }
    }
    ensure!(!rows.is_empty(), "found no figure, expected one at least");
    Ok(rows)
}

impl RunResult {
    /// Reads the result of a run; `None` when there is none, or when it belongs to another command.
    ///
    /// # Errors
    /// Fails when the file cannot be read or has a line that is no result.
    pub fn load(docs: &Path, run: &Run) -> anyhow::Result<Option<Self>> {
        let file = file(docs, run);
        if !file.exists() {
            return Ok(None);
        }
        let named = || file.display().to_string();
        let text = std::fs::read_to_string(&file).with_context(named)?;
        let (head, printed) = text.split_once('\n').unwrap_or((&text, ""));
        let head: Head = serde_json::from_str(head).with_context(named)?;
        if head.command != run.command {
            return Ok(None);
        }
        let rows = rows(printed).with_context(named)?;
        Ok(Some(Self { head, rows }))
    }
}

/// Stores the result of a run.
///
/// # Errors
/// Fails when the file cannot be written.
pub fn store(docs: &Path, run: &Run, head: &Head, printed: &str) -> anyhow::Result<()> {
    let file = file(docs, run);
    let head = serde_json::to_string(head)?;
    let written = std::fs::create_dir_all(folder(docs))
        .and_then(|()| std::fs::write(&file, format!("{head}\n{printed}")));
    written.with_context(|| format!("writing {}", file.display()))
}

/// Returns the folder of the results.
pub fn folder(docs: &Path) -> PathBuf {
    docs.join("figures/results")
}

fn file(docs: &Path, run: &Run) -> PathBuf {
    folder(docs).join(format!("{}.jsonl", run.name))
}
