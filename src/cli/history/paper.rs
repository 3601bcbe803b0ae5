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
    /// Language of the page; when absent, that of the locale (LC_ALL, LC_MESSAGES, LANG), else en
    #[arg(long, value_enum)]
    lang: Option<LangArg>,
    /// HTML file to write, for A4 (print it from a browser); - is stdout
    #[arg(long, default_value = "-")]
    out: PathBuf,
}

impl LangArg {
    /// Returns the language of `option`; for `None`, the language of the locale.
    pub fn or_locale(option: Option<Self>) -> Lang {
        match option {
            Some(Self::En) => Lang::En,
            Some(Self::Zh) => Lang::Zh,
            None => of_locale(LOCALE.map(|it| std::env::var(it).unwrap_or_default())),
        }
    }
}

/// Variables of the locale; the first that is not empty decides (POSIX.1-2017, 8.2).
const LOCALE: [&str; 3] = ["LC_ALL", "LC_MESSAGES", "LANG"];

/// Returns the language that the values of [`LOCALE`] name; English when they name neither English nor Chinese.
fn of_locale(values: [String; 3]) -> Lang {
    let decides = values.into_iter().find(|it| !it.is_empty());
    match decides.is_some_and(|it| it.starts_with("zh")) {
        true => Lang::Zh,
        false => Lang::En,
    }
}

impl PaperArgs {
    /// Returns the settings of a page about the selected runs, in the chosen language.
    pub(super) fn paper_of(&self, archive: &Archive, filter: &Filter) -> anyhow::Result<Paper> {
        let language = LangArg::or_locale(self.lang);
        Ok(inquiry::paper::paper_of(archive, filter, language)?)
    }

    /// Returns the settings of a page in the chosen language, without the mark SIMULATION.
    pub fn paper(&self) -> Paper {
        inquiry::paper::paper(LangArg::or_locale(self.lang))
    }

    pub fn write(&self, page: &str) -> anyhow::Result<()> {
        write_page(&self.out, page)
    }
}

/// Writes a page to a file, or to stdout for `-`.
pub(in crate::cli) fn write_page(file: &Path, page: &str) -> anyhow::Result<()> {
    let mut out = sink(file)?;
    out.write_all(page.as_bytes())?;
    let name = file.display();
    out.flush().with_context(|| format!("writing {name}"))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_variable_of_the_locale_decides() {
        let said = |values: [&str; 3]| of_locale(values.map(str::to_owned));
        assert_eq!(said(["", "", "zh_CN.UTF-8"]), Lang::Zh);
        assert_eq!(said(["", "zh_TW", "en_GB.UTF-8"]), Lang::Zh);
        assert_eq!(said(["C.UTF-8", "", "zh_CN.UTF-8"]), Lang::En);
        assert_eq!(said(["", "", "de_DE.UTF-8"]), Lang::En);
        assert_eq!(said(["", "", ""]), Lang::En);
    }
}
