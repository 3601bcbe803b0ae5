//! `history export`: CSV that spreadsheets open as UTF-8, or a spreadsheet with charts.

use super::filter::{PartArgs, RangeArgs};
use super::paper::{LangArg, sink};
use anyhow::Context;
use app::copies;
use app::progress::{PIECES, progress};
use clap::{Args, ValueEnum};
use history::inquiry::{checks, export, paper};
use history::{Archive, Filter, csv::BYTE_ORDER_MARK};
use std::io::Write;
use std::path::{Path, PathBuf};

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// Comma-separated values
    Csv,
    /// Spreadsheet with a summary and native charts
    Xlsx,
}

#[derive(Debug, Args)]
pub(super) struct ExportArgs {
    #[command(flatten)]
    parts: PartArgs,
    #[command(flatten)]
    range: RangeArgs,
    /// File to write; - is stdout (CSV only). A name that ends in .xlsx gives a spreadsheet
    #[arg(default_value = "-")]
    file: PathBuf,
    /// Form of the file; when absent, from the end of its name
    #[arg(long, value_enum)]
    format: Option<Kind>,
    /// Language of the spreadsheet, by default that of the locale, else en; CSV has keys and codes
    #[arg(long, value_enum)]
    lang: Option<LangArg>,
}

/// Exports parts; marks the runs of the history file `db` as exported, if they come from one.
pub(super) fn run(archive: &Archive, db: Option<&Path>, args: &ExportArgs) -> anyhow::Result<()> {
    let filter = args.parts.within(&args.range)?;
    checks::known_runs(archive, &filter)?;
    let parameters = checks::parameters(archive, filter.param.as_deref())?;
    let is_spreadsheet = args
        .file
        .extension()
        .is_some_and(|it| it.eq_ignore_ascii_case("xlsx"));
    let by_name = if is_spreadsheet {
        Kind::Xlsx
    } else {
        Kind::Csv
    };
    let written = match args.format.unwrap_or(by_name) {
        Kind::Csv => {
            let mut out = sink(&args.file)?;
            out.write_all(BYTE_ORDER_MARK.as_bytes())?;
            export::csv_lines(archive, &filter, &parameters, &mut out)?;
            let name = args.file.display();
            out.flush().with_context(|| format!("writing {name}"))
        }
        Kind::Xlsx => spreadsheet(archive, &filter, &parameters, args),
    };
    written?;
    match db.filter(|_| args.file.as_os_str() != "-") {
        None => Ok(()),
        Some(db) => copies::exported(db, &filter, &args.file),
    }
}

fn spreadsheet(
    archive: &Archive,
    filter: &Filter,
    parameters: &[String],
    args: &ExportArgs,
) -> anyhow::Result<()> {
    let file: &Path = &args.file;
    anyhow::ensure!(
        file.as_os_str() != "-",
        "a spreadsheet needs a file, found -"
    );
    let name = file.display();
    let bar = progress(Some(archive.count_parts(filter)?), PIECES);
    let paper = paper::paper_of(archive, filter, LangArg::or_locale(args.lang))?;
    let mut workbook = export::spreadsheet(archive, filter, parameters, &paper, || bar.inc(1))?;
    bar.finish_and_clear();
    workbook
        .save(file)
        .with_context(|| format!("writing {name}"))
}
