//! `history query`: parts that a filter leaves, one at a time from file to stdout.

use super::filter::{PartArgs, RangeArgs, known_parameter};
use super::output::{Format, FormatArgs, Output, Table, figure, text};
use crate::history::{Archive, Filter, Part, csv};
use clap::Args;
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

const COLUMNS: [&str; 13] = [
    "time",
    "lot",
    "run",
    "kind",
    "seq",
    "recipe",
    "serial",
    "verdict",
    "bin",
    "landed_bin",
    "reasons",
    "test_s",
    "cycle_s",
];

pub(super) fn run(archive: &Archive, args: &QueryArgs) -> anyhow::Result<()> {
    let filter = args.parts.within(&args.range)?;
    let parameters = archive.parameters()?;
    if let Some(param) = &filter.param {
        known_parameter(&parameters, param)?;
    }
    let mut out = Output::stdout();
    match args.format.format() {
        Format::Json => archive.each(&filter, |part| out.json(&part))??,
        Format::Csv => write_csv(archive, &filter, &parameters, &mut out)?,
        Format::Table => write_table(archive, &filter, &parameters, &mut out)?,
    }
    Ok(out.flush()?)
}

/// All columns: values first, then their uncertainties. Reads back with `history import`.
pub(super) fn write_csv(
    archive: &Archive,
    filter: &Filter,
    parameters: &[String],
    out: &mut Output,
) -> anyhow::Result<()> {
    let uncertainties: Vec<String> = parameters
        .iter()
        .map(|key| format!("uncertainty {key}"))
        .collect();
    let keys = parameters.iter().chain(&uncertainties).map(String::as_str);
    csv::write(out, COLUMNS.into_iter().chain(keys))?;
    archive.each(filter, |part| {
        let mut cells = cells(&part);
        for map in [&part.values, &part.uncertainty] {
            cells.extend(parameters.iter().map(|key| text(number(map, key))));
        }
        csv::write(out, cells.iter().map(String::as_str))
    })??;
    Ok(())
}

/// As many columns as a person reads: those parameters that the first parts have.
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
    let header: Vec<&str> = ["time", "lot", "run", "seq", "verdict", "bin"]
        .into_iter()
        .chain(shown.clone())
        .collect();
    let mut table = Table::new(&[header, vec!["reasons"]].concat());
    archive.each(filter, |part| {
        let mut row = vec![
            part.time.to_string(),
            part.lot.clone(),
            part.run.to_string(),
            part.seq.to_string(),
            part.verdict.clone(),
            text(part.bin.as_ref()),
        ];
        row.extend(shown.iter().map(|key| figure(number(&part.values, key))));
        row.push(part.reasons.join("; "));
        table.row(out, row)
    })??;
    Ok(table.finish(out)?)
}

/// In order of [`COLUMNS`].
fn cells(part: &Part) -> Vec<String> {
    vec![
        part.time.to_string(),
        part.lot.clone(),
        part.run.to_string(),
        part.kind.clone(),
        part.seq.to_string(),
        part.recipe.clone(),
        text(part.serial.as_ref()),
        part.verdict.clone(),
        text(part.bin.as_ref()),
        text(part.landed_bin.as_ref()),
        part.reasons.join("; "),
        text(part.test_s),
        text(part.cycle_s),
    ]
}

fn number(map: &serde_json::Map<String, serde_json::Value>, key: &str) -> Option<f64> {
    map.get(key).and_then(serde_json::Value::as_f64)
}
