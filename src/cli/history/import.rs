//! `history import`: all of a file or nothing, and the same file into the same lot only once. CSV, or a
//! spreadsheet by the end of its name.

mod sheet;

use crate::cli::output::input;
use anyhow::Context;
use app::exit::Exit;
use clap::Args;
use history::{
    Archive, Filter, Identity, ImportRow, LOT_NAME, LotRecord, PartRecord, Store, csv, is_lot_name,
    parse_records, snapshot_hash,
};
use std::io::Read;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(super) struct ImportArgs {
    /// CSV file (UTF-8 with or without byte order mark; - is stdin) or spreadsheet (xlsx, xls, ods)
    file: PathBuf,
    /// Lot to put the parts into
    #[arg(long)]
    lot: String,
    /// A column of the file and the key it stands for; may be given several times
    #[arg(long = "map", value_name = "COLUMN=KEY", value_parser = pair)]
    maps: Vec<(String, String)>,
    /// Sheet of the spreadsheet; the first when absent
    #[arg(long, value_name = "NAME")]
    sheet: Option<String>,
}

/// No column with a key.
#[derive(Debug, thiserror::Error)]
#[error("expected COLUMN=KEY")]
struct NoPair;

fn pair(text: &str) -> Result<(String, String), NoPair> {
    let parts = text.split_once('=').ok_or(NoPair)?;
    Ok((parts.0.trim().to_owned(), parts.1.trim().to_owned()))
}

pub(super) fn run(db: &Path, args: &ImportArgs) -> anyhow::Result<Exit> {
    anyhow::ensure!(
        is_lot_name(&args.lot),
        "--lot: found {:?}, expected {LOT_NAME}",
        args.lot
    );
    let name = args.file.display();
    let mut bytes = Vec::new();
    input(&args.file)
        .and_then(|mut file| file.read_to_end(&mut bytes))
        .with_context(|| format!("reading {name}"))?;
    let records = if sheet::is_named_so(&args.file) {
        let zone = jiff::tz::TimeZone::system();
        sheet::records(&args.file, args.sheet.as_deref(), &zone)
    } else {
        text(&bytes).and_then(|text| Ok(csv::read(text)?))
    };
    let records = records.with_context(|| name.to_string())?;
    let mut store = Store::open(db, &Identity::of_this_program())?;
    let archive = Archive::open(db)?;
    let snapshot = format!(
        "# imported from a file with SHA-256 {}\n",
        snapshot_hash(&bytes)
    );
    let now_us = jiff::Timestamp::now().as_microsecond();
    let lot = lot_record(&args.lot, snapshot, now_us);
    only_once(&archive, &lot).with_context(|| name.to_string())?;
    let rows = parse_records(&records, &args.maps, &archive.parameters()?)
        .with_context(|| name.to_string())?;
    let parts = numbered(rows, &args.lot, now_us);
    let count = parts.len();
    let run = store.import(&lot, parts)?;
    eprintln!("{name}: {count} parts into lot {:?}, run {run}", args.lot);
    Ok(Exit::Done)
}

/// In order of the file; a row without a time gets that of the import.
fn numbered(rows: Vec<ImportRow>, lot: &str, now_us: i64) -> Vec<PartRecord> {
    let part = |(seq, row): (u64, ImportRow)| {
        let judged_at_us = if row.timed {
            row.part.judged_at_us
        } else {
            now_us
        };
        PartRecord {
            lot: lot.to_owned(),
            seq,
            judged_at_us,
            ..row.part
        }
    };
    (1..).zip(rows).map(part).collect()
}

fn text(bytes: &[u8]) -> anyhow::Result<&str> {
    std::str::from_utf8(bytes).map_err(|cause| {
        let good = &bytes[..cause.valid_up_to()];
        let line = 1 + good.iter().filter(|&&it| it == b'\n').count();
        anyhow::anyhow!("line {line}: expected UTF-8 (save the file as \"CSV UTF-8\")")
    })
}

fn lot_record(lot: &str, recipe_snapshot: String, opened_at_us: i64) -> LotRecord {
    LotRecord {
        lot: lot.to_owned(),
        recipe: "imported".to_owned(),
        recipe_hash: snapshot_hash(&recipe_snapshot),
        recipe_snapshot,
        opened_at_us,
        ..LotRecord::default()
    }
}

fn only_once(archive: &Archive, lot: &LotRecord) -> anyhow::Result<()> {
    let filter = Filter {
        lot: Some(lot.lot.clone()),
        ..Filter::default()
    };
    match archive
        .lots(&filter)?
        .iter()
        .find(|it| it.recipe_hash == lot.recipe_hash)
    {
        None => Ok(()),
        Some(before) => anyhow::bail!(
            "this very file is in lot {:?} already, as run {}; nothing was imported",
            before.lot,
            before.run
        ),
    }
}
