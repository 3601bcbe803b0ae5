//! `history show`: a lot with its runs, or a part with everything that was measured on it.

use super::output::{Format, FormatArgs, Output, Table, figure, text};
use super::{lots, orders};
use clap::Args;
use history::{Archive, Filter, LotSummary, Moment, Part};
use machine::dut;
use machine::instrument::curve::Curve;
use std::io::Write;

#[derive(Debug, Args)]
pub(super) struct ShowArgs {
    /// Name of the lot
    lot: String,
    /// Number of the part in the lot
    seq: Option<u64>,
    /// Only this run of the lot (1, 2, ...)
    #[arg(long, value_name = "N")]
    run: Option<u32>,
    /// The golden part of that number
    #[arg(long)]
    golden: bool,
    #[command(flatten)]
    format: FormatArgs,
}

pub(super) fn run(archive: &Archive, args: &ShowArgs) -> anyhow::Result<()> {
    let mut out = Output::stdout();
    let lot = &args.lot;
    let filter = Filter {
        lot: Some(lot.clone()),
        run: args.run,
        ..Filter::default()
    };
    let lots = archive.lots(&filter)?;
    anyhow::ensure!(
        !lots.is_empty(),
        "no lot {lot:?} (or no such run); see `history list`"
    );
    match args.seq {
        None => {
            whole_lot(&lots, args.format.format(), &mut out)?;
            if args.format.format() == Format::Table {
                let ordered = archive.orders(&filter, None)?;
                writeln!(out, "{} orders", ordered.len())?;
                orders::write(&ordered, Format::Table, &mut out)?;
            }
        }
        Some(seq) => one_part(archive, args, seq, &mut out)?,
    }
    Ok(out.flush()?)
}

fn whole_lot(lots: &[LotSummary], format: Format, out: &mut Output) -> anyhow::Result<()> {
    lots::write(lots, format, out)?;
    if format == Format::Table {
        for lot in lots {
            let bins: Vec<String> = lot
                .bins
                .iter()
                .map(|(bin, n)| format!("{bin} {n}"))
                .collect();
            let bins = if bins.is_empty() {
                "none".to_owned()
            } else {
                bins.join(", ")
            };
            writeln!(out, "bins of run {}: {bins}", lot.run)?;
        }
    }
    Ok(())
}

fn one_part(archive: &Archive, args: &ShowArgs, seq: u64, out: &mut Output) -> anyhow::Result<()> {
    let (lot, kind) = (&args.lot, if args.golden { "golden" } else { "lot" });
    let mut parts = archive.show(lot, seq, kind)?;
    parts.retain(|part| args.run.is_none_or(|run| part.run == run));
    anyhow::ensure!(
        !parts.is_empty(),
        "lot {lot:?} has no part {seq} of kind {kind}"
    );
    parts
        .iter()
        .try_for_each(|part| match args.format.format() {
            Format::Json => out.json(part),
            Format::Table | Format::Csv => page(part, out),
        })
}

/// For a person; CSV has no form for a part with its replies, so it gets this page too.
fn page(part: &Part, out: &mut Output) -> anyhow::Result<()> {
    let Part {
        lot,
        run,
        kind,
        seq,
        recipe,
        verdict,
        ..
    } = part;
    writeln!(
        out,
        "lot {lot}, run {run}, {kind} part {seq}, recipe {recipe}, {}",
        part.time
    )?;
    writeln!(out, "serial   {}", text(part.serial.as_ref()))?;
    writeln!(out, "verdict  {verdict} {}", part.reasons.join("; "))?;
    let landed = match (&part.landed_bin, part.landed_at) {
        (Some(bin), Some(at)) => format!("landed in {bin} at {at}"),
        (Some(bin), None) => format!("landed in {bin}"),
        (None, _) => "not seen landing".to_owned(),
    };
    writeln!(
        out,
        "bin      {}, {landed}",
        part.bin.as_deref().unwrap_or("none")
    )?;
    let seconds =
        |it: Option<f64>| it.map_or("-".to_owned(), |it| format!("{} s", figure(Some(it))));
    writeln!(
        out,
        "time     test {}, cycle {}",
        seconds(part.test_s),
        seconds(part.cycle_s)
    )?;
    writeln!(out)?;
    measurements(part, out)?;
    writeln!(out)?;
    samples(part, out)?;
    part.curves.iter().try_for_each(|it| curve(it, out))
}

/// Samples on a line: milliseconds since the first one, and the value.
const ON_A_LINE: usize = 6;

/// A sample that gave no number is a dash.
fn curve(it: &Curve, out: &mut Output) -> anyhow::Result<()> {
    let Curve {
        signal,
        unit,
        begin_us,
        ..
    } = it;
    let begin = Moment(*begin_us);
    let bits = dut::bits_of(signal);
    let unit = match unit.as_str() {
        "" => bits.unwrap_or("counts"),
        unit => unit,
    };
    writeln!(out, "\ncurve {signal}, {unit}, from {begin}, ms: value")?;
    let samples: Vec<String> = it
        .t_us
        .iter()
        .zip(&it.values)
        .map(|(&t_us, value)| {
            let value = match value {
                None => "-".to_owned(),
                Some(word) if bits.is_some() => format!("{:09b}", *word as u64),
                Some(value) => figure(Some(*value)),
            };
            format!("{:.3}: {value}", t_us as f64 / 1e3)
        })
        .collect();
    for line in samples.chunks(ON_A_LINE) {
        writeln!(out, "  {}", line.join("   "))?;
    }
    Ok(())
}

fn measurements(part: &Part, out: &mut Output) -> anyhow::Result<()> {
    let header = [
        "parameter",
        "attempt",
        "value",
        "+- (k=2)",
        "low",
        "high",
        "verdict",
    ];
    let mut table = Table::new(&header);
    for it in &part.measurements {
        let mut row = vec![it.parameter.clone(), it.attempt.to_string()];
        row.extend([it.value, it.uncertainty, it.low, it.high].map(figure));
        row.push(it.verdict.clone());
        table.row(out, row)?;
    }
    Ok(table.finish(out)?)
}

fn samples(part: &Part, out: &mut Output) -> anyhow::Result<()> {
    let mut table = Table::new(&[
        "parameter",
        "attempt",
        "line",
        "module",
        "channel",
        "command",
        "reply",
        "at",
    ]);
    for it in &part.measurements {
        for sample in &it.samples {
            let row = vec![
                it.parameter.clone(),
                it.attempt.to_string(),
                sample.line.clone(),
                sample.module.clone(),
                sample.channel.clone(),
                sample.command.clone(),
                sample.raw.clone(),
                sample.at.to_string(),
            ];
            table.row(out, row)?;
        }
    }
    Ok(table.finish(out)?)
}
