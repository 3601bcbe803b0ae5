//! `history query`: parts that match a filter, one at a time from file to stdout.

use super::filter::{PartArgs, RangeArgs};
use crate::cli::output::{Format, FormatArgs, Output, Table, figure, text};
use clap::Args;
use history::inquiry::{checks, export};
use history::{Archive, Filter};
use std::io::Write;

#[derive(Debug, Args)]
pub(super) struct QueryArgs {
    #[command(flatten)]
    parts: PartArgs,
    #[command(flatten)]
    range: RangeArgs,
    #[command(flatten)]
    format: FormatArgs,
}

pub(super) fn run(archive: &Archive, args: &QueryArgs) -> anyhow::Result<()> {
    let filter = args.parts.within(&args.range)?;
    warn_unknown(archive, &filter);
    let parameters = checks::parameters(archive, filter.param.as_deref())?;
    let mut out = Output::stdout();
    match args.format.format() {
        Format::Json => archive.each(&filter, |part| out.json(&part))??,
        Format::Csv => export::csv_lines(archive, &filter, &parameters, &mut out)?,
        Format::Table => write_table(archive, &filter, &parameters, &mut out)?,
    }
    Ok(out.flush()?)
}

/// Warns of an unknown lot, run or recipe; the empty answer stays valid.
pub(super) fn warn_unknown(archive: &Archive, filter: &Filter) {
    if let Err(unknown) = checks::known_runs(archive, filter) {
        eprintln!("{unknown}");
    }
}

/// Writes a table with the parameters of the first parts as columns.
fn write_table(
    archive: &Archive,
    filter: &Filter,
    parameters: &[String],
    out: &mut Output,
) -> anyhow::Result<()> {
    let first = archive.query(&Filter {
        limit: Some(20),
        ..filter.clone()
    })?;
    let shown: Vec<&str> = match &filter.param {
        Some(param) => vec![param.as_str()],
        None => parameters
            .iter()
            .filter(|&key| first.iter().any(|part| part.values.contains_key(key)))
            .map(String::as_str)
            .collect(),
    };
    let of_rigs = first.iter().any(|part| part.rig.is_some());
    let mut headings = if of_rigs { vec!["rig"] } else { Vec::new() };
    headings.extend(["time", "lot", "run", "seq", "verdict", "bin"]);
    headings.extend(&shown);
    headings.push("reasons");
    let mut table = Table::new(&headings);
    archive.each(filter, |part| {
        let mut row: Vec<String> = part.rig.iter().filter(|_| of_rigs).cloned().collect();
        row.extend([
            part.time.local(),
            part.lot.clone(),
            part.run.to_string(),
            part.seq.to_string(),
            part.verdict.clone(),
            text(part.bin.as_ref()),
        ]);
        row.extend(shown.iter().map(|key| figure(number(&part.values, key))));
        row.push(part.reasons.join("; "));
        table.row(out, row)
    })??;
    Ok(table.finish(out)?)
}

fn number(map: &serde_json::Map<String, serde_json::Value>, key: &str) -> Option<f64> {
    map.get(key).and_then(serde_json::Value::as_f64)
}
