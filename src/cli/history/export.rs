//! `history export`: CSV that spreadsheets open right, Chinese included, or a spreadsheet with charts.

use super::filter::{PartArgs, RangeArgs};
use super::paper::{Tongue, sink};
use anyhow::Context;
use app::progress::{PIECES, progress};
use clap::{Args, ValueEnum};
use history::inquiry::{checks, export};
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
    /// Lang of the spreadsheet's summary
    #[arg(long, value_enum, default_value = "zh")]
    lang: Tongue,
}

pub(super) fn run(db: &Path, args: &ExportArgs) -> anyhow::Result<()> {
    let archive = &Archive::open(db)?;
    let filter = args.parts.within(&args.range)?;
    checks::known_runs(archive, &filter)?;
    let parameters = checks::parameters(archive, filter.param.as_deref())?;
    let named_so = args
        .file
        .extension()
        .is_some_and(|it| it.eq_ignore_ascii_case("xlsx"));
    let by_name = if named_so { Kind::Xlsx } else { Kind::Csv };
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
    if args.file.as_os_str() != "-" && whole_runs(&filter) {
        std::fs::File::open(&args.file)?.sync_all()?;
        super::copied(db, &filter, &args.file)?;
    }
    Ok(())
}

/// Whether the filter takes every part of the runs that it takes, golden ones included.
fn whole_runs(filter: &Filter) -> bool {
    let runs = Filter {
        lot: filter.lot.clone(),
        run: filter.run,
        recipe: filter.recipe.clone(),
        kind: Some("all".to_owned()),
        ..Filter::default()
    };
    *filter == runs
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
    let language = args.lang.language();
    let mut workbook = export::spreadsheet(archive, filter, parameters, language, || bar.inc(1))?;
    bar.finish_and_clear();
    workbook
        .save(file)
        .with_context(|| format!("writing {name}"))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use calamine::{Data, Reader, Xlsx};
    use history::Part;
    use history::report::Lang;
    use history::report::sheet::Sheet;
    use jiff::tz::TimeZone;
    use std::io::Cursor;

    const LOT: &str = "<b>批次\"1\"</b>";

    fn part(operate_v: f64) -> Part {
        let mut part = Part::fixture(LOT, 7, "pass");
        part.values
            .insert("operate_voltage_v".into(), operate_v.into());
        part.serial = Some("=1+1".into());
        part
    }

    #[test]
    fn a_spreadsheet_reads_back_as_it_was_written_with_its_charts_and_no_formula() {
        let keys = ["operate_voltage_v".to_owned()];
        let mut sheet = Sheet::new(Lang::En, TimeZone::UTC, &keys).unwrap();
        for _ in 0..3 {
            sheet.part(&part(7.704_22)).unwrap();
        }
        sheet.part(&part(9.5)).unwrap();
        let bytes = sheet.finish().unwrap().save_to_buffer().unwrap();
        let chart = b"xl/charts/chart2.xml";
        assert!(bytes.windows(chart.len()).any(|it| it == chart));
        let mut book: Xlsx<_> = Xlsx::new(Cursor::new(bytes)).unwrap();
        assert_eq!(book.sheet_names(), ["Summary", "Parts"]);
        let parts = book.worksheet_range("Parts").unwrap();
        assert_eq!(parts.height(), 5);
        assert_eq!(parts[(1, 1)], Data::String(LOT.into()));
        assert_eq!(parts[(1, 6)], Data::String("=1+1".into()));
        assert_eq!(parts[(1, 13)], Data::Float(7.704_22));
        assert!(book.worksheet_formula("Parts").unwrap().is_empty());
        let summary = book.worksheet_range("Summary").unwrap();
        assert_eq!(
            (&summary[(1, 1)], &summary[(1, 5)]),
            (&Data::Float(4.0), &Data::Float(9.5))
        );
    }
}
