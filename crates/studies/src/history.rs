//! Speed of the history on a made-up file as large as weeks of production.
//!
//! The generator of `history generate` writes the file into a temporary directory. Every query runs as the program runs
//! it and reads its rows to the end. All times are wall times. Most of the new file is in the page cache of the
//! operating system, as the latest weeks are on a rig in production.

use super::chart::Chart;
use super::figure::{Bar, Figure};
use super::order::{Order, memory_kb};
use super::output::Report;
use anyhow::Context;
use app::generate::{GenerateOptions, generate};
use app::progress::{PIECES, progress};
use history::inquiry::figures::figures;
use history::{Archive, Filter, LotRecord, Moment, Row, Store};
use machine::dut::em_relay::Parameter;
use quality::Ordered;
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Number of parts in the larger exported spreadsheet.
const SHEET: u64 = 100_000;
/// Number of parts in the smaller exported spreadsheet; the larger one must not need much more memory.
const LESSER: u64 = 10_000;
/// Number of parts that the study writes one by one, each in its own transaction.
const SINGLE: u64 = 500;
/// Number of filter queries.
const FILTERS: usize = 300;
/// Interval between two readings of the memory of the exporting process.
const LOOK: Duration = Duration::from_millis(5);

/// Writes the file, runs every query and makes the report.
///
/// # Errors
/// Fails when a file cannot be written or read.
pub fn study(order: &Order) -> anyhow::Result<Report> {
    let folder = TempDir::new()?;
    let db = folder.path().join("history.db");
    let wanted = GenerateOptions {
        parts: order.parts,
        seed: 1,
        recipe: order.recipe.name.clone(),
        until: None,
    };
    let bar = progress(Some(order.parts), PIECES);
    let made = generate(&order.folder(), &db, &wanted, |parts| {
        bar.set_position(parts)
    })?;
    bar.finish_and_clear();
    let n = made.parts;
    let rate = n as f64 / made.writing.as_secs_f64();
    let gigabytes = std::fs::metadata(&db)?.len() as f64 / 1e9;
    let writing = vec![
        Figure::new("inserted, 1000 parts a transaction", n, Some(rate), "/s")
            .bar(Bar::AtLeast(2_000.0)),
        Figure::count("measurement rows", n, Some(made.measurements)),
        Figure::new("file", n, Some(gigabytes), "GB"),
        one_by_one(&db.with_file_name("single.db"))?,
    ];
    let archive = Archive::open(&db)?;
    let all = Filter::default();
    let reading = vec![
        filters(&archive)?,
        last_day(&archive)?,
        stats(&archive, &db, "stats of one parameter, p95", &all)?.bar(Bar::AtMost(300.0)),
        stats(&archive, &db, "of its good parts, p95", &good())?,
    ];
    let sheet = sheets(order, &db)?;
    let title = format!("wall time of queries over {n} parts");
    let chart = Chart::of(title, "ms", vec![50.0, 300.0], &reading);
    let about = format!("{n} made-up parts of {}", order.recipe.name);
    Ok(Report::new(
        "history",
        about,
        vec![writing, reading, sheet],
        chart,
    ))
}

/// Runs `work`, appends its wall time in ms to `spent`, and returns its result.
fn timed<T>(spent: &mut Vec<f64>, work: impl FnOnce() -> T) -> T {
    let began = Instant::now();
    let result = work();
    spent.push(began.elapsed().as_secs_f64() * 1e3);
    result
}

/// Writes parts as a rig does: one transaction and one flush for each.
fn one_by_one(db: &Path) -> anyhow::Result<Figure> {
    let mut store = Store::open(db)?;
    store.begin_lot(&LotRecord {
        lot: "single".into(),
        recipe: "none".into(),
        ..LotRecord::default()
    })?;
    let mut spent = Vec::new();
    for seq in 1..=SINGLE {
        let part = history::PartRecord {
            lot: "single".into(),
            seq,
            verdict: "pass".into(),
            kind: "lot".into(),
            measurements: Parameter::ALL.iter().map(measured).collect(),
            ..Default::default()
        };
        timed(&mut spent, || store.record(&[Row::Part(part)]))?;
    }
    Ok(times("one part a transaction, p99", &spent, 0.99))
}

fn measured(parameter: &Parameter) -> history::MeasurementRecord {
    history::MeasurementRecord {
        key: parameter.name().into(),
        value: Some(1.0),
        verdict: "pass".into(),
        attempt: 1,
        ..Default::default()
    }
}

/// Runs the filter queries by lot, verdict and value range: alternately rejects over a wide range and good parts over a
/// narrow range.
fn filters(archive: &Archive) -> anyhow::Result<Figure> {
    let lots = archive.lots(&Filter::default())?;
    let mut spent = Vec::new();
    let mut rows = 0;
    for n in 0..FILTERS {
        let lot = &lots[n * 7919 % lots.len()];
        let parameter = Parameter::ALL[n % Parameter::ALL.len()];
        let of_lot = Filter {
            lot: Some(lot.lot.clone()),
            ..Filter::default()
        };
        let values = Ordered::of(&archive.values(parameter.name(), &of_lot)?.values);
        let (verdict, range) = if n % 2 == 0 {
            ("fail", [0.5, 1.0])
        } else {
            ("pass", [0.48, 0.52])
        };
        let [min, max] = range.map(|p| values.quantile(p));
        let filter = Filter {
            verdict: Some(verdict.into()),
            param: Some(parameter.name().into()),
            min,
            max,
            ..of_lot
        };
        rows += timed(&mut spent, || archive.query(&filter))?.len();
    }
    Ok(times("lot + verdict + value range, p95", &spent, 0.95)
        .with("parts_each", Some(rows as f64 / FILTERS as f64))
        .bar(Bar::AtMost(50.0)))
}

fn last_day(archive: &Archive) -> anyhow::Result<Figure> {
    let lots = archive.lots(&Filter::default())?;
    let end = lots
        .last()
        .and_then(|it| it.closed)
        .context("the last lot is open")?;
    let since = Moment(end.0 - 86_400_000_000);
    let mut spent = Vec::new();
    let mut parts = 0;
    for _ in 0..50 {
        parts = timed(&mut spent, || archive.yield_between(since, end))?.parts;
    }
    Ok(times("yield of the last 24 hours, p95", &spent, 0.95)
        .with("parts_each", Some(parts as f64))
        .bar(Bar::AtMost(50.0)))
}

/// Query that reads the same values inside SQLite and returns only their sum: the least time of one pass over them.
const PLAIN: &str = "SELECT total(m.value) FROM measurement AS m
    JOIN parameter ON parameter.id = m.parameter_id
    WHERE parameter.key = ?1 AND m.population = 'lot'";

/// Returns a filter for the parts that passed. With this filter, the history must read single values instead of the
/// packed values of whole runs.
fn good() -> Filter {
    Filter {
        verdict: Some("pass".to_owned()),
        ..Filter::default()
    }
}

/// Computes the statistics of every parameter three times, each after a plain pass over all values.
fn stats(archive: &Archive, db: &Path, name: &str, filter: &Filter) -> anyhow::Result<Figure> {
    let plain = rusqlite::Connection::open(db)?;
    let mut passes = Vec::new();
    let mut spent = Vec::new();
    let mut parts = 0;
    for parameter in Parameter::ALL.iter().cycle().take(3 * Parameter::ALL.len()) {
        let key = parameter.name();
        let sum = |row: &rusqlite::Row| row.get::<_, f64>(0);
        timed(&mut passes, || plain.query_row(PLAIN, [key], sum))?;
        let found = timed(&mut spent, || figures(archive, key, filter, None))?;
        parts = found.summary.n;
    }
    let plain = Ordered::of(&passes).quantile(0.5);
    let ratio = Ordered::of(&spent).quantile(0.5).zip(plain);
    Ok(times(name, &spent, 0.95)
        .with("parts_each", Some(parts as f64))
        .with("plain_pass", plain)
        .with("median_over_plain", ratio.map(|(ours, plain)| ours / plain)))
}

/// Exports spreadsheets of two sizes, each in a process of its own; returns the time of the larger one and the memory
/// of both.
fn sheets(order: &Order, db: &Path) -> anyhow::Result<Vec<Figure>> {
    let (_, little) = exported(order, db, LESSER)?;
    let (wall, much) = exported(order, db, SHEET)?;
    let n = SHEET.min(order.parts);
    Ok(vec![
        Figure::new("export to a spreadsheet", n, Some(wall), "s").bar(Bar::AtMost(20.0)),
        Figure::new("its peak memory", n, much, "MB")
            .with("of_a_tenth_mb", little)
            .bar(Bar::AtMost(64.0)),
    ])
}

/// Exports a spreadsheet; returns wall seconds, and the peak of resident memory in MB on Linux.
fn exported(order: &Order, db: &Path, parts: u64) -> anyhow::Result<(f64, Option<f64>)> {
    let from = Instant::now();
    let mut command = order.command(db, "warn");
    command.args(["history", "export", "--limit", &parts.to_string()]);
    command
        .arg(db.with_file_name("parts.xlsx"))
        .stdout(Stdio::null());
    let mut child = command.spawn().context("starting the export")?;
    let mut peak = None;
    loop {
        if let Some(status) = child.try_wait()? {
            anyhow::ensure!(status.success(), "the export ended with {status}");
            return Ok((from.elapsed().as_secs_f64(), peak));
        }
        let kb = memory_kb(child.id(), "VmHWM");
        peak = kb.map(|kb| kb as f64 / 1024.0).or(peak);
        std::thread::sleep(LOOK);
    }
}

/// Returns the quantile `p` of times in milliseconds, with median and 99 % quantile as further columns.
fn times(name: &str, spent: &[f64], p: f64) -> Figure {
    let ordered = Ordered::of(spent);
    Figure::new(name, spent.len() as u64, ordered.quantile(p), "ms")
        .with("median", ordered.quantile(0.5))
        .with("p99", ordered.quantile(0.99))
}
