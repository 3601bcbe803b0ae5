//! `history results` and `history import-results`: results that a plant measured outside of the rig, see
//! [`mod@app::import::results`].

use super::import::bytes_of;
use crate::cli::output::{Column, Format, FormatArgs, Output, figure, text};
use crate::cli::person;
use app::exit::Exit;
use app::import::Source;
use app::import::results::{Purpose, import_results};
use clap::Args;
use history::report::{Lang, external_sentence};
use history::{Archive, Entered, ExternalResult, Filter, inquiry::checks};
use std::io::Write;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(super) struct ResultsArgs {
    /// Name of the lot
    lot: String,
    #[command(flatten)]
    format: FormatArgs,
}

#[derive(Debug, Args)]
pub(super) struct ImportResultsArgs {
    /// CSV file (- is stdin) or spreadsheet with columns key and value, optionally serial, run, seq, unit, u, at
    file: PathBuf,
    /// Lot of the samples
    #[arg(long)]
    lot: String,
    /// Recipe for which the results are meant; refused when the lot was run with another one
    #[arg(long, value_name = "NAME")]
    recipe: Option<String>,
    /// Person who enters the results
    #[arg(long, visible_alias = "who", value_name = "NAME")]
    by: String,
}

const COLUMNS: [Column<ExternalResult>; 11] = [
    ("sample", |it| text(it.sample())),
    ("parameter", |it| it.key.clone()),
    ("value", |it| figure(Some(it.value))),
    ("+- (k=2)", |it| figure(it.uncertainty)),
    ("low", |it| figure(it.low)),
    ("high", |it| figure(it.high)),
    ("verdict", |it| it.verdict.name().to_owned()),
    ("superseded", |it| it.superseded.to_string()),
    ("measured", |it| it.measured.local()),
    ("who", |it| it.who.clone()),
    ("line", |it| text(it.line)),
];

pub(super) fn run(archive: &Archive, args: &ResultsArgs) -> anyhow::Result<()> {
    let of_lot = Filter {
        lot: Some(args.lot.clone()),
        ..Filter::default()
    };
    checks::known_runs(archive, &of_lot)?;
    let mut out = Output::stdout();
    let format = args.format.format();
    if format == Format::Table {
        standing(archive, &args.lot, &mut out)?;
    }
    out.list(format, &archive.external_results(&args.lot)?, &COLUMNS)
}

/// Writes the results below a heading; nothing without any.
pub(super) fn table(results: &[ExternalResult], out: &mut Output) -> anyhow::Result<()> {
    if !results.is_empty() {
        writeln!(out, "results from outside of the rig")?;
        out.table(results, &COLUMNS)?;
        writeln!(out)?;
    }
    Ok(())
}

/// Writes whether the lot is acceptable by its results; nothing for a lot that has and needs none.
pub(super) fn standing(archive: &Archive, lot: &str, out: &mut Output) -> anyhow::Result<()> {
    if let Some(standing) = archive.external_standing(lot)? {
        writeln!(out, "{}", external_sentence(Lang::En, &standing))?;
    }
    Ok(())
}

pub(super) fn import(db: &Path, args: &ImportResultsArgs) -> anyhow::Result<Exit> {
    let name = args.file.display();
    let bytes = bytes_of(&args.file)?;
    let source = Source {
        file: &args.file,
        bytes: &bytes,
        sheet: None,
        maps: &[],
    };
    let purpose = Purpose {
        lot: &args.lot,
        recipe: args.recipe.as_deref(),
        who: &person(&args.by)?.who,
    };
    let Entered {
        pass,
        fail,
        undecided,
    } = import_results(db, &source, purpose)?;
    eprintln!(
        "{name}: {pass} passed, {fail} failed, {undecided} undecided, into lot {:?}",
        args.lot
    );
    let mut out = Output::stdout();
    standing(&Archive::open(db)?, &args.lot, &mut out)?;
    out.flush()?;
    Ok(Exit::Done)
}
