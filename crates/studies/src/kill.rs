//! Kills a running lot at random instants (`kill -9`) and checks the rows that the history holds afterwards.
//!
//! Every round starts a lot in its own process, kills it with SIGKILL after a random time (before the first part, in
//! the middle of a transaction, between the beam of a bin and the record of the landing), opens the same history and
//! compares its rows with the parts that the process printed. The process prints a part when the light beam of its bin
//! confirms it, and the gripper opens only after the row is durable. Every printed part must therefore have one row
//! with the same verdict and bin, and curves if it failed; the numbers of the parts must have no gap; and the file must
//! be undamaged. One round in three counts the time to the kill from the start of the process, the others from the
//! first printed part; otherwise a busy machine would see every lot killed before its first part. All rounds share one
//! history. After every tenth round a short lot must run to its end in it.

use super::chart::Chart;
use super::dice::Dice;
use super::figure::Figure;
use super::order::Order;
use super::output::Report;
use anyhow::Context;
use app::progress::{PIECES, progress};
use history::{Archive, Filter, Part};
use serde_json::Value;
use std::fs::File;
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Longest time to the kill, ms; a lot prints about thirty parts in this time.
const LONGEST_MS: u64 = 1_500;
/// One round in this number counts the time to the kill from the start of the process.
const FROM_START: u64 = 3;
/// Longest wait for the first part of a lot; after it, the study kills the lot all the same.
const FIRST_PART_TIMEOUT: Duration = Duration::from_secs(30);
/// Interval at which the study polls for the first part.
const LOOK: Duration = Duration::from_millis(5);
/// Number of parts of a lot: more than it can test before the kill.
const ENDLESS: u64 = 1_000_000;

/// Counts over all rounds, for the figures of [`report`].
#[derive(Debug, Default)]
struct Counts {
    early: u64,
    reported: u64,
    rows: u64,
    lost: u64,
    other: u64,
    gaps: u64,
    without_curve: u64,
    damaged: u64,
    restarts: u64,
    refused: u64,
}

/// Kills the lots of the order and makes the report.
///
/// # Errors
/// Fails when a process does not start, or when the history cannot be read.
pub fn study(order: &Order) -> anyhow::Result<Report> {
    let folder = TempDir::new()?;
    let db = folder.path().join("history.db");
    let mut counts = Counts::default();
    let mut instants = Vec::new();
    let bar = progress(Some(order.lots), PIECES);
    // The fixed seed makes each run of the study kill at the same instants.
    let mut dice = Dice::new(0);
    for round in 0..order.lots {
        let instant = dice.below(LONGEST_MS);
        let reported = run_and_kill(order, &db, round, instant)?;
        instants.push(instant as f64);
        counts.early += u64::from(reported.is_empty());
        if db.exists() {
            compare_rows(&db, &name(round), &reported, &mut counts)?;
        }
        if round % 10 == 9 {
            counts.restarts += 1;
            let lot = format!("after {}", name(round));
            counts.refused += u64::from(!short_lot_completes(order, &db, &lot)?);
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(report(order, &counts, &instants))
}

fn report(order: &Order, it: &Counts, instants: &[f64]) -> Report {
    let bars = vec![
        Figure::none("printed parts without their row", it.reported, it.lost),
        Figure::none(
            "printed parts with another verdict or bin",
            it.reported,
            it.other,
        ),
        Figure::none(
            "lots whose numbers have a gap or a duplicate",
            order.lots,
            it.gaps,
        ),
        Figure::none(
            "printed parts that failed and have no curve",
            it.reported,
            it.without_curve,
        ),
        Figure::none("kills that damaged the file", order.lots, it.damaged),
        Figure::none(
            "lots that could not run afterwards",
            it.restarts,
            it.refused,
        ),
    ];
    let information = vec![
        Figure::count(
            "kills before the first printed part",
            order.lots,
            Some(it.early),
        ),
        Figure::count("rows of parts", order.lots, Some(it.rows)),
    ];
    let spread = quality::Ordered::of(instants);
    let title = "instants of the kills after the start of the process, or its first part";
    let quartiles = [0.0, 0.25, 0.5, 0.75, 1.0]
        .map(|p| (format!("{p} of the kills up to"), spread.quantile(p)));
    let chart = Chart::new(title, "ms", Vec::new(), quartiles);
    let about = format!(
        "{} lots of {} killed at random instants",
        order.lots, order.recipe.name
    );
    Report::new("kill", about, vec![bars, information], chart)
}

fn name(round: u64) -> String {
    format!("K{round}")
}

/// Runs the lot, kills it, and returns the parts that it printed.
fn run_and_kill(
    order: &Order,
    db: &Path,
    round: u64,
    instant_ms: u64,
) -> anyhow::Result<Vec<Value>> {
    let out = db.with_file_name("rows.jsonl");
    let file = File::create(&out).context("making the file for the rows of the lot")?;
    let mut child = start_lot(order, db, (&name(round), ENDLESS), round + 1, file.into())?;
    if !round.is_multiple_of(FROM_START) {
        let born = Instant::now();
        while std::fs::metadata(&out)?.len() == 0 && born.elapsed() < FIRST_PART_TIMEOUT {
            std::thread::sleep(LOOK);
        }
    }
    std::thread::sleep(Duration::from_millis(instant_ms));
    child.kill().context("killing the lot")?;
    child.wait()?;
    let text = std::fs::read_to_string(&out)?;
    // The last line may be cut off.
    let whole = text.rsplit_once('\n').map_or("", |(whole, _)| whole);
    let rows = whole.lines().map(serde_json::from_str::<Value>);
    let rows: Vec<Value> = rows.collect::<Result<_, _>>().context("rows of the lot")?;
    Ok(rows.into_iter().filter(|it| it["type"] == "part").collect())
}

fn start_lot(
    order: &Order,
    db: &Path,
    (lot, parts): (&str, u64),
    seed: u64,
    out: Stdio,
) -> anyhow::Result<Child> {
    let mut command = order.lot_command(lot, db, parts, seed);
    command.stdout(out).stderr(Stdio::null());
    command.spawn().context("starting a lot")
}

/// Runs a short lot in the same history and returns whether it completes.
fn short_lot_completes(order: &Order, db: &Path, lot: &str) -> anyhow::Result<bool> {
    let mut child = start_lot(order, db, (lot, 2), 1, Stdio::null())?;
    Ok(child.wait()?.success())
}

/// Compares the rows of the lot with the printed parts.
fn compare_rows(
    db: &Path,
    lot: &str,
    reported: &[Value],
    counts: &mut Counts,
) -> anyhow::Result<()> {
    let archive = Archive::open(db)?;
    counts.damaged += u64::from(archive.check().is_err());
    let filter = Filter {
        lot: Some(lot.to_owned()),
        ..Filter::default()
    };
    let rows = archive.query(&filter)?;
    counts.rows += rows.len() as u64;
    counts.reported += reported.len() as u64;
    let mut numbers: Vec<u64> = rows.iter().map(|row| row.seq).collect();
    numbers.sort_unstable();
    let in_order = numbers.iter().copied().eq(1..=numbers.len() as u64);
    counts.gaps += u64::from(!in_order);
    for part in reported {
        let of_part: Vec<&Part> = rows.iter().filter(|row| part["seq"] == row.seq).collect();
        match of_part.as_slice() {
            [row] => {
                counts.other += u64::from(!is_same(row, part));
                counts.without_curve +=
                    u64::from(row.verdict == "fail" && !has_curves(&archive, row)?);
            }
            _ => counts.lost += 1,
        }
    }
    Ok(())
}

fn has_curves(archive: &Archive, row: &Part) -> anyhow::Result<bool> {
    let shown = archive.show(&row.lot, row.seq, &row.kind)?;
    Ok(shown.iter().all(|it| !it.curves.is_empty()))
}

/// Returns true when the printed part and its row agree on verdict and bin, and when the row records no landing in
/// another bin.
fn is_same(row: &Part, reported: &Value) -> bool {
    reported["verdict"] == row.verdict.as_str()
        && reported["bin"] == row.bin.as_deref().unwrap_or_default()
        && row
            .landed_bin
            .as_ref()
            .is_none_or(|bin| reported["bin"] == bin.as_str())
}
