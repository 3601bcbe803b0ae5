//! The plan of the figures, `figures/plan.toml` in the folder of the documents: in sections, the runs that make the
//! figures, and explanations for the reader.

use super::page::anchor;
use anyhow::{Context, ensure};
use serde::Deserialize;
use std::collections::BTreeSet;
use std::path::Path;

/// The whole plan.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    /// Markdown below the title of the document.
    pub about: String,
    /// Sections, in the order of the document.
    #[serde(rename = "section")]
    pub sections: Vec<Section>,
}

/// A section of the document.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Section {
    /// Heading.
    pub title: String,
    /// Sentences below the heading.
    pub about: String,
    /// Runs, in the order of the document.
    #[serde(rename = "run")]
    pub runs: Vec<Run>,
}

/// A command that prints figures as lines of JSON.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Run {
    /// Name of the result, in small letters, digits and hyphens.
    pub name: String,
    /// Heading of the figures.
    pub title: String,
    /// Sentences below the heading.
    #[serde(default)]
    pub about: String,
    /// Program and arguments of the run, separated by spaces; the runner adds `--json`. The word `relayrig` means this
    /// program.
    pub command: String,
    /// Machine that the figures need.
    pub machine: Machine,
    /// Prefixes of the names of the figures to show; when empty, the document shows all. A missed bar is always shown.
    #[serde(default)]
    pub shows: Vec<String>,
    /// Pictures below the figures.
    #[serde(default)]
    pub pictures: Vec<Picture>,
    /// Longer variants of the run, which take too long for the plan; a reader starts them by hand.
    #[serde(default)]
    pub larger: Vec<Larger>,
}

/// Machine that the figures of a run need.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Machine {
    /// Rig time and counts, which are the same on every machine.
    Any,
    /// Wall times, which need a machine that does nothing else.
    Quiet,
}

/// A picture of a run.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Picture {
    /// Name of the file in the folder `pictures`.
    pub file: String,
    /// What the picture shows.
    pub about: String,
    /// How to draw the picture from the figures; without it, the study itself draws the picture (`--out`).
    pub plot: Option<Plot>,
}

/// A plot of figures, both axes logarithmic.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plot {
    /// Words that the name of a figure must contain to be drawn.
    #[serde(default)]
    pub figures: Vec<String>,
    /// Column or columns of the x axis.
    ///
    /// With the name of a column, each figure is one point: x is that column, y the value. With a prefix and `*`, each
    /// figure is a curve: every column with this prefix is a point, whose x stands in its name in the place of the `*`
    /// and whose y is the number in the column.
    pub column: String,
    /// Title of the x axis.
    pub x: String,
    /// Title of the y axis.
    pub y: String,
}

/// A longer run that a reader starts by hand.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Larger {
    /// Program and arguments of the run.
    pub command: String,
    /// What the run shows, and how long it takes.
    pub about: String,
}

impl Plan {
    /// Loads the plan of a folder of documents.
    ///
    /// # Errors
    /// Fails when the file cannot be read, has an unknown key, or names a run or a heading twice.
    pub fn load(docs: &Path) -> anyhow::Result<Self> {
        let file = docs.join("figures/plan.toml");
        let named = || file.display().to_string();
        let text = std::fs::read_to_string(&file).with_context(named)?;
        Self::read(&text).with_context(named)
    }

    /// Reads a plan.
    ///
    /// # Errors
    /// Fails as [`Plan::load`] does.
    pub fn read(text: &str) -> anyhow::Result<Self> {
        let plan: Self = toml::from_str(text)?;
        let (mut names, mut anchors) = (BTreeSet::new(), BTreeSet::new());
        let sections = plan.sections.iter().map(|it| it.title.as_str());
        for title in sections.chain(plan.runs().map(|it| it.title.as_str())) {
            ensure!(
                anchors.insert(anchor(title)),
                "title: found {title:?} twice, expected each heading once"
            );
        }
        for Run { name, command, .. } in plan.runs() {
            let is_name = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
            ensure!(
                !name.is_empty() && name.chars().all(is_name),
                "name: found {name:?}, expected small letters, digits and hyphens"
            );
            ensure!(
                names.insert(name),
                "name: found {name:?} twice, expected each run once"
            );
            ensure!(
                command.split_whitespace().count() > 1,
                "command of {name}: found {command:?}, expected a program and its arguments"
            );
        }
        Ok(plan)
    }

    /// Returns the runs of all sections.
    pub fn runs(&self) -> impl Iterator<Item = &Run> {
        self.sections.iter().flat_map(|section| &section.runs)
    }
}
