//! Options of pages for print: language and file.

use crate::cli::output::Output;
use anyhow::Context;
use clap::{Args, ValueEnum};
use history::report::{Lang, Paper};
use history::{Archive, Filter, inquiry};
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum LangArg {
    /// English
    En,
    /// Simplified Chinese
    Zh,
}

/// File and language of a page.
#[derive(Debug, Args)]
pub(in crate::cli) struct PaperArgs {
    /// Language of the page
    #[arg(long, value_enum, default_value = "zh")]
    lang: LangArg,
    /// HTML file to write, for A4 (print it from a browser); - is stdout
    #[arg(long, default_value = "-")]
    out: PathBuf,
}

impl LangArg {
    pub fn language(self) -> Lang {
        match self {
            Self::En => Lang::En,
            Self::Zh => Lang::Zh,
        }
    }
}

impl PaperArgs {
    /// Returns paper of this language for the selected runs, made now.
    pub(super) fn paper_of(&self, archive: &Archive, filter: &Filter) -> anyhow::Result<Paper> {
        let language = self.lang.language();
        Ok(inquiry::paper::paper_of(archive, filter, language)?)
    }

    /// Returns the settings of a printed page: its language, and now as the time of printing.
    pub fn paper(&self) -> Paper {
        inquiry::paper::paper(self.lang.language())
    }

    pub fn write(&self, page: &str) -> anyhow::Result<()> {
        let mut out = sink(&self.out)?;
        out.write_all(page.as_bytes())?;
        let name = self.out.display();
        out.flush().with_context(|| format!("writing {name}"))
    }
}

/// Creates the file, or opens stdout for `-`.
pub(super) fn sink(file: &Path) -> anyhow::Result<Output> {
    if file.as_os_str() == "-" {
        return Ok(Output::stdout());
    }
    let name = file.display();
    let made = File::create(file).with_context(|| format!("making {name}"))?;
    Ok(Output::to(made))
}
