//! `history show`: a lot with its runs, or a part with its measurements.

use super::{lots, orders, results};
use crate::cli::output::{Column, Format, FormatArgs, Output, bins, figure, text};
use clap::Args;
use history::{Archive, Filter, LotSummary, Measurement, Moment, OrderChoice, Part, Sample};
use machine::dut;
use machine::instrument::curve::Curve;
use std::io::{self, Write};

#[derive(Debug, Args)]
pub(super) struct ShowArgs {
    /// Name of the lot
    #[arg(required_unless_present = "serial")]
    lot: Option<String>,
    /// Number of the part in the lot
    seq: Option<u64>,
    /// Only this run of the lot (1, 2, ...)
    #[arg(long, value_name = "N")]
    run: Option<u32>,
    /// Every test of the part with this serial number, in all lots
    #[arg(long, value_name = "SERIAL", conflicts_with_all = ["lot", "run", "golden"])]
    serial: Option<String>,
    /// The reference part with this number instead of the production part
    #[arg(long)]
    golden: bool,
    #[command(flatten)]
    format: FormatArgs,
}

pub(super) fn run(archive: &Archive, args: &ShowArgs) -> anyhow::Result<()> {
    let mut out = Output::stdout();
    if let Some(serial) = &args.serial {
        let parts = archive.of_serial(serial)?;
        anyhow::ensure!(
            !parts.is_empty(),
            "no part has the serial number {serial:?}"
        );
        show_parts(&parts, args, &mut out)?;
        return Ok(out.flush()?);
    }
    let lot = args.lot.as_deref().unwrap_or_default();
    let filter = Filter {
        lot: Some(lot.to_owned()),
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
            let format = args.format.format();
            out.list(format, &lots, &lots::COLUMNS)?;
            if format == Format::Table {
                for LotSummary {
                    run, bins: counts, ..
                } in &lots
                {
                    let all = bins(counts);
                    writeln!(
                        out,
                        "bins of run {run}: {}",
                        if all.is_empty() { "none" } else { &all }
                    )?;
                }
                results::standing(archive, lot, &mut out)?;
                results::table(&archive.external_results(lot)?, &mut out)?;
                let ordered = archive.orders(&filter, &OrderChoice::default())?;
                writeln!(out, "{} orders", ordered.len())?;
                out.table(&ordered, &orders::COLUMNS)?;
            }
        }
        Some(seq) => one_part(archive, args, (lot, seq), &mut out)?,
    }
    Ok(out.flush()?)
}

fn one_part(
    archive: &Archive,
    args: &ShowArgs,
    (lot, seq): (&str, u64),
    out: &mut Output,
) -> anyhow::Result<()> {
    let kind = if args.golden { "golden" } else { "lot" };
    let mut parts = archive.show(lot, seq, kind)?;
    parts.retain(|part| args.run.is_none_or(|run| part.run == run));
    anyhow::ensure!(
        !parts.is_empty(),
        "lot {lot:?} has no part {seq} of kind {kind}"
    );
    show_parts(&parts, args, out)
}

fn show_parts(parts: &[Part], args: &ShowArgs, out: &mut Output) -> anyhow::Result<()> {
    parts
        .iter()
        .try_for_each(|part| match args.format.format() {
            Format::Json => out.json(part),
            Format::Table | Format::Csv => page(part, out),
        })
}

/// Writes a part as text, even with `--format csv`, because CSV cannot hold a part with its replies.
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
        part.time.local()
    )?;
    writeln!(out, "serial   {}", text(part.serial.as_ref()))?;
    writeln!(out, "verdict  {verdict} {}", part.reasons.join("; "))?;
    let landed = match (&part.landed_bin, part.landed_at) {
        (Some(bin), Some(at)) => format!("landed in {bin} at {}", at.local()),
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
    out.table(&part.measurements, &MEASUREMENTS)?;
    writeln!(out)?;
    results::table(&part.external, out)?;
    samples(part, out)?;
    part.curves.iter().try_for_each(|it| curve(it, out))
}

/// Number of samples on a line of text, each with the milliseconds since the first one.
const ON_A_LINE: usize = 6;

/// Writes a curve; a dash is a sample without a number.
fn curve(it: &Curve, out: &mut Output) -> anyhow::Result<()> {
    let Curve {
        signal,
        unit,
        begin_us,
        ..
    } = it;
    let begin = Moment(*begin_us).local();
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

const MEASUREMENTS: [Column<Measurement>; 7] = [
    ("parameter", |it| it.parameter.clone()),
    ("attempt", |it| it.attempt.to_string()),
    ("value", |it| figure(it.value)),
    ("+- (k=2)", |it| figure(it.uncertainty)),
    ("low", |it| figure(it.low)),
    ("high", |it| figure(it.high)),
    ("verdict", |it| it.verdict.clone()),
];

fn samples(part: &Part, out: &mut Output) -> io::Result<()> {
    let samples = part
        .measurements
        .iter()
        .flat_map(|it| it.samples.iter().map(move |sample| (it, sample)));
    let columns: [Column<(&Measurement, &Sample)>; 8] = [
        ("parameter", |it| it.0.parameter.clone()),
        ("attempt", |it| it.0.attempt.to_string()),
        ("line", |it| it.1.line.clone()),
        ("module", |it| it.1.module.clone()),
        ("channel", |it| it.1.channel.clone()),
        ("command", |it| it.1.command.clone()),
        ("reply", |it| it.1.raw.clone()),
        ("at", |it| it.1.at.local()),
    ];
    out.table(&samples.collect::<Vec<_>>(), &columns)
}
