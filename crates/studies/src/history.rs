//! Speed of the history on a made-up file as large as weeks of production.
//!
//! The file is written by `history generate` into a folder of its own and thrown away with it. Every
//! query is asked as the program asks it, rows read to the end. Wall times; the file was just written, so
//! most of it is in the page cache of the system, as that of a plant's latest weeks is.

use super::chart::Chart;
use super::figure::{Bar, Figure};
use super::fleet::{Folder, Order};
use super::output::Report;
use anyhow::Context;
use app::generate::{GenerateOptions, generate};
use app::progress::{PIECES, progress};
use history::inquiry::figures::figures;
use history::{Archive, Filter, Identity, LotRecord, Moment, Row, Store};
use machine::dut::em_relay::Parameter;
use quality::Ordered;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Parts of the sheet that is exported.
const SHEET: u64 = 100_000;
/// Parts of the lesser sheet that its memory is compared with.
const LESSER: u64 = 10_000;
/// Parts written one by one.
const SINGLE: u64 = 500;
/// Filters asked.
const FILTERS: usize = 300;
/// Between two looks at the memory of the export.
const LOOK: Duration = Duration::from_millis(5);

/// Writes the file, asks everything of it and makes the report.
///
/// # Errors
/// A file that could not be written or read.
pub fn study(order: &Order) -> anyhow::Result<Report> {
    let folder = Folder::new()?;
    let db = folder.0.join("history.db");
    let wanted = GenerateOptions {
        parts: order.parts,
        seed: 1,
        recipe: order.recipe.clone(),
        until: None,
    };
    let bar = progress(Some(order.parts), PIECES);
    let made = generate(&order.config, &db, &wanted, |parts| bar.set_position(parts))?;
    bar.finish_and_clear();
    let rate = made.parts as f64 / made.writing.as_secs_f64();
    let mut writing = vec![
        Figure::new(
            "inserted, 1000 parts a transaction",
            made.parts,
            Some(rate),
            "/s",
        )
        .bar(Bar::AtLeast(2_000.0)),
        Figure::count("measurement rows", made.parts, Some(made.measurements)),
        Figure::new(
            "file",
            made.parts,
            Some(std::fs::metadata(&db)?.len() as f64 / 1e9),
            "GB",
        ),
    ];
    writing.push(one_by_one(&folder.0.join("single.db"))?);
    let archive = Archive::open(&db)?;
    let reading = vec![
        filters(&archive)?,
        last_day(&archive)?,
        stats(
            &archive,
            &db,
            "stats of one parameter, p95",
            &Filter::default(),
        )?
        .bar(Bar::AtMost(300.0)),
        stats(&archive, &db, "of its good parts, p95", &good())?,
    ];
    let sheet = sheets(order, &folder.0, &db)?;
    let chart = Chart::of(
        format!("wall time of queries over {} parts", made.parts),
        "ms",
        vec![50.0, 300.0],
        &reading,
    );
    Ok(Report {
        study: "history",
        about: format!("{} made-up parts of {}", made.parts, order.recipe),
        groups: vec![writing, reading, sheet],
        notes: Vec::new(),
        chart,
    })
}

/// A rig records its parts alone: one transaction and one flush each.
fn one_by_one(db: &Path) -> anyhow::Result<Figure> {
    let mut store = Store::open(db, &Identity::of_this_program())?;
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
        let from = Instant::now();
        store.record(&[Row::Part(part)])?;
        spent.push(from.elapsed().as_secs_f64() * 1e3);
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

/// Lot, verdict and value range together; rejects over a wide range, good parts over a narrow one.
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
        let from = Instant::now();
        rows += archive.query(&filter)?.len();
        spent.push(from.elapsed().as_secs_f64() * 1e3);
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
        let from = Instant::now();
        parts = archive.yield_between(since, end)?.parts;
        spent.push(from.elapsed().as_secs_f64() * 1e3);
    }
    Ok(times("yield of the last 24 hours, p95", &spent, 0.95)
        .with("parts_each", Some(parts as f64))
        .bar(Bar::AtMost(50.0)))
}

/// What SQLite itself takes to pass over the values that statistics are made of: nothing leaves it but a sum.
const PLAIN: &str = "SELECT total(m.value) FROM measurement AS m
    JOIN parameter ON parameter.id = m.parameter_id
    WHERE parameter.key = ?1 AND m.population = 'lot'";

/// A filter for which the packed values of whole runs are of no use.
fn good() -> Filter {
    Filter {
        verdict: Some("pass".to_owned()),
        ..Filter::default()
    }
}

/// Every parameter three times, from the query to the last figure; before each the plain pass over all values.
fn stats(archive: &Archive, db: &Path, name: &str, filter: &Filter) -> anyhow::Result<Figure> {
    let plain = rusqlite::Connection::open(db)?;
    let mut passes = Vec::new();
    let mut spent = Vec::new();
    let mut parts = 0;
    for parameter in Parameter::ALL.iter().cycle().take(3 * Parameter::ALL.len()) {
        let from = Instant::now();
        plain.query_row(PLAIN, [parameter.name()], |row| row.get::<_, f64>(0))?;
        passes.push(from.elapsed().as_secs_f64() * 1e3);
        let from = Instant::now();
        let found = figures(archive, parameter.name(), filter, None)?;
        parts = found.summary.n;
        spent.push(from.elapsed().as_secs_f64() * 1e3);
    }
    let plain = Ordered::of(&passes).quantile(0.5);
    let ratio = Ordered::of(&spent).quantile(0.5).zip(plain);
    Ok(times(name, &spent, 0.95)
        .with("parts_each", Some(parts as f64))
        .with("plain_pass", plain)
        .with("median_over_plain", ratio.map(|(ours, plain)| ours / plain)))
}

/// Spreadsheets of two sizes, each by a process of its own: time of the greater, memory of both.
fn sheets(order: &Order, folder: &Path, db: &Path) -> anyhow::Result<Vec<Figure>> {
    let (_, little) = exported(order, folder, db, LESSER)?;
    let (wall, much) = exported(order, folder, db, SHEET)?;
    let n = SHEET.min(order.parts);
    Ok(vec![
        Figure::new("export to a spreadsheet", n, Some(wall), "s").bar(Bar::AtMost(20.0)),
        Figure::new("its peak memory", n, much, "MB")
            .with("of_a_tenth_mb", little)
            .bar(Bar::AtMost(64.0)),
    ])
}

/// Wall seconds, and peak of resident memory in MB where the system tells it (Linux).
fn exported(
    order: &Order,
    folder: &Path,
    db: &Path,
    parts: u64,
) -> anyhow::Result<(f64, Option<f64>)> {
    let from = Instant::now();
    let mut child = Command::new(&order.program)
        .args(["--log", "warn", "--db"])
        .arg(db)
        .args(["history", "export", "--limit", &parts.to_string()])
        .arg(folder.join("parts.xlsx"))
        .stdout(Stdio::null())
        .spawn()
        .context("starting the export")?;
    let mut peak = None;
    loop {
        if let Some(status) = child.try_wait()? {
            anyhow::ensure!(status.success(), "the export ended with {status}");
            return Ok((from.elapsed().as_secs_f64(), peak));
        }
        peak = peak_memory_mb(child.id()).or(peak);
        std::thread::sleep(LOOK);
    }
}

fn peak_memory_mb(process: u32) -> Option<f64> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find(|it| it.starts_with("VmHWM:"))?;
    let kilobytes: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kilobytes / 1024.0)
}

/// Milliseconds at the share `p`, with median and greatest beside it.
fn times(name: &str, spent: &[f64], p: f64) -> Figure {
    let ordered = Ordered::of(spent);
    Figure::new(name, spent.len() as u64, ordered.quantile(p), "ms")
        .with("median", ordered.quantile(0.5))
        .with("p99", ordered.quantile(0.99))
}
