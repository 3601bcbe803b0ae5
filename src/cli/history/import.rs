//! `history import`: parts of an older system, see [`mod@app::import`].

use crate::cli::output::input;
use anyhow::Context;
use app::exit::Exit;
use app::import::{Imported, Source, import};
use clap::Args;
use history::{LOT_NAME, is_lot_name};
use std::io::Read;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(super) struct ImportArgs {
    /// CSV file (UTF-8 with or without byte order mark; - is stdin) or spreadsheet (xlsx, xls, ods)
    file: PathBuf,
    /// Lot to put the parts into
    #[arg(long)]
    lot: String,
    /// Parameter key for a column of the file; may be given several times
    #[arg(long = "map", value_name = "COLUMN=KEY", value_parser = pair)]
    maps: Vec<(String, String)>,
    /// Sheet of the spreadsheet; the first when absent
    #[arg(long, value_name = "NAME")]
    sheet: Option<String>,
}

/// Error: the text is not `COLUMN=KEY`.
#[derive(Debug, thiserror::Error)]
#[error("expected COLUMN=KEY")]
struct PairError;

fn pair(text: &str) -> Result<(String, String), PairError> {
    let parts = text.split_once('=').ok_or(PairError)?;
    Ok((parts.0.trim().to_owned(), parts.1.trim().to_owned()))
}

/// Returns the content of a file, or of the standard input for `-`.
pub(super) fn bytes_of(file: &Path) -> anyhow::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    input(file)
        .and_then(|mut file| file.read_to_end(&mut bytes))
        .with_context(|| format!("reading {}", file.display()))?;
    Ok(bytes)
}

pub(super) fn run(db: &Path, args: &ImportArgs) -> anyhow::Result<Exit> {
    anyhow::ensure!(
        is_lot_name(&args.lot),
        "--lot: found {:?}, expected {LOT_NAME}",
        args.lot
    );
    let name = args.file.display();
    let bytes = bytes_of(&args.file)?;
    let source = Source {
        file: &args.file,
        bytes: &bytes,
        sheet: args.sheet.as_deref(),
        maps: &args.maps,
    };
    let Imported {
        parts,
        run,
        ignored,
    } = import(db, &source, &args.lot)?;
    eprintln!("{name}: {parts} parts into lot {:?}, run {run}", args.lot);
    if !ignored.is_empty() {
        eprintln!("{name}: ignored columns {}", ignored.join(", "));
    }
    Ok(Exit::Done)
}
