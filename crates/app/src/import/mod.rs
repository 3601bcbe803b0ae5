//! Imports a file of an older system, CSV or spreadsheet depending on its extension. A file is imported whole or not at
//! all, and only once into the same lot.

pub mod results;
mod sheet;
#[cfg(test)]
mod tests;

use anyhow::Context;
use history::{
    Archive, Filter, ImportRow, LotRecord, PartRecord, Store, csv, ignored_columns, parse_records,
    snapshot_hash,
};
use std::path::Path;

/// A file to import.
#[derive(Debug)]
pub struct Source<'a> {
    /// Path of the file; its extension says whether it is a spreadsheet or CSV.
    pub file: &'a Path,
    /// Content of the file.
    pub bytes: &'a [u8],
    /// Name of the sheet to read from a spreadsheet; `None`: the first sheet.
    pub sheet: Option<&'a str>,
    /// Pairs of a column's name in the file and the key of the values in this column.
    pub maps: &'a [(String, String)],
}

/// The run that holds the parts of an imported file.
#[derive(Debug)]
pub struct Imported {
    /// Number of parts.
    pub parts: usize,
    /// Number of the run within its lot.
    pub run: u32,
    /// Columns of the file that the import ignores, such as those of uncertainties.
    pub ignored: Vec<String>,
}

/// Puts the parts of a file into a new run of `lot`.
///
/// # Errors
/// Fails on a file without readable records, with an unknown column or an invalid cell, or that the lot already has.
pub fn import(db: &Path, source: &Source, lot: &str) -> anyhow::Result<Imported> {
    let name = || source.file.display().to_string();
    let records = records(source).with_context(name)?;
    let mut store = Store::open(db)?;
    let archive = Archive::open(db)?;
    let snapshot = format!(
        "# imported from a file with SHA-256 {}\n",
        snapshot_hash(source.bytes)
    );
    let now_us = jiff::Timestamp::now().as_microsecond();
    let record = lot_record(lot, snapshot, now_us);
    refuse_second_import(&archive, &record).with_context(name)?;
    let rows = parse_records(&records, source.maps, &archive.parameters()?).with_context(name)?;
    let parts = numbered(rows, lot, now_us);
    Ok(Imported {
        parts: parts.len(),
        run: store.import(&record, parts)?,
        ignored: ignored_columns(&records),
    })
}

fn records(source: &Source) -> anyhow::Result<Vec<csv::Record>> {
    if sheet::is_spreadsheet(source.file) {
        let zone = jiff::tz::TimeZone::system();
        return sheet::records(source.file, source.sheet, &zone);
    }
    Ok(csv::read(text(source.bytes)?)?)
}

/// Numbers the parts in the order of the file; a row without a time gets the time of the import.
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

fn refuse_second_import(archive: &Archive, lot: &LotRecord) -> anyhow::Result<()> {
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
