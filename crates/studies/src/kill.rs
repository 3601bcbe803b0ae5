//! `kill -9` of a running lot at random instants: what the history holds afterwards.
//!
//! Every round starts a lot in a process of its own, ends it by SIGKILL after a random time (before the
//! first part, in the middle of a transaction, between beam and row), opens the same history again and sets
//! the rows against what the process had told. A part is told when the beam of its bin has confirmed it,
//! and the gripper opens only over durable rows: so every told part must have its rows, once, with the
//! same verdict and bin, and its curves when it failed; parts must be numbered without a gap; and the file must
//! be whole. Of three rounds one counts its time from the start of the process, two from the first told part:
//! a busy machine shall not kill every lot before it has done anything.
//! All rounds share one history. Every tenth round a short lot runs to its end in it.

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

/// Longest life of a lot, ms; some thirty parts are told by then.
const LONGEST_MS: u64 = 1_500;
/// One round of so many counts from the start of the process.
const FROM_START: u64 = 3;
/// A lot that has told nothing for so long is killed all the same.
const PATIENCE: Duration = Duration::from_secs(30);
/// Between two looks at what was told.
const LOOK: Duration = Duration::from_millis(5);
/// Parts of a lot: more than it lives for.
const ENDLESS: u64 = 1_000_000;

/// Counts over all rounds.
#[derive(Debug, Default)]
struct Counts {
    early: u64,
    told: u64,
    rows: u64,
    lost: u64,
    other: u64,
    gaps: u64,
    bare: u64,
    damaged: u64,
    restarts: u64,
    refused: u64,
}

/// Kills as many lots as the order has and makes the report.
///
/// # Errors
/// A process that could not be started or a history that could not be read.
pub fn study(order: &Order) -> anyhow::Result<Report> {
    let folder = TempDir::new()?;
    let db = folder.path().join("history.db");
    let mut counts = Counts::default();
    let mut instants = Vec::new();
    let bar = progress(Some(order.lots), PIECES);
    // A seed of its own, so that each run of the study kills at the same instants.
    let mut dice = Dice::new(0);
    for round in 0..order.lots {
        let instant = dice.below(LONGEST_MS);
        let told = killed(order, &db, round, instant)?;
        instants.push(instant as f64);
        counts.early += u64::from(told.is_empty());
        if db.exists() {
            held(&db, &name(round), &told, &mut counts)?;
        }
        if round % 10 == 9 {
            counts.restarts += 1;
            counts.refused += u64::from(!again(order, &db)?);
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(report(order, &counts, &instants))
}

fn report(order: &Order, it: &Counts, instants: &[f64]) -> Report {
    let bars = vec![
        Figure::none("told parts without their row", it.told, it.lost),
        Figure::none("told parts with another verdict or bin", it.told, it.other),
        Figure::none(
            "lots whose numbers have a gap or a double",
            order.lots,
            it.gaps,
        ),
        Figure::none("told parts that failed and have no curve", it.told, it.bare),
        Figure::none("kills that damaged the file", order.lots, it.damaged),
        Figure::none(
            "lots that could not run afterwards",
            it.restarts,
            it.refused,
        ),
    ];
    let information = vec![
        Figure::count("kills before a part was told", order.lots, Some(it.early)),
        Figure::count("rows of parts", order.lots, Some(it.rows)),
    ];
    let spread = quality::Ordered::of(instants);
    let title = "instants of the kills after the start of the process, or its first part";
    let quartiles = [0.0, 0.25, 0.5, 0.75, 1.0]
        .map(|p| (format!("{p} of the kills up to"), spread.quantile(p)));
    let chart = Chart::new(title, "ms", Vec::new(), quartiles);
    let about = format!(
        "{} lots of {} killed at random instants",
        order.lots, order.recipe
    );
    Report::new("kill", about, vec![bars, information], chart)
}

fn name(round: u64) -> String {
    format!("K{round}")
}

/// Runs the lot, kills it, and gives the parts it had told.
fn killed(order: &Order, db: &Path, round: u64, instant_ms: u64) -> anyhow::Result<Vec<Value>> {
    let out = db.with_file_name("told.jsonl");
    let file = File::create(&out).context("making the file of what is told")?;
    let mut child = started(order, db, (&name(round), ENDLESS), round + 1, file.into())?;
    if !round.is_multiple_of(FROM_START) {
        let born = Instant::now();
        while std::fs::metadata(&out)?.len() == 0 && born.elapsed() < PATIENCE {
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

fn started(
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

/// A short lot in the same history, to its end.
fn again(order: &Order, db: &Path) -> anyhow::Result<bool> {
    let mut child = started(order, db, ("after", 2), 1, Stdio::null())?;
    Ok(child.wait()?.success())
}

/// Sets the rows of the lot against what was told.
fn held(db: &Path, lot: &str, told: &[Value], counts: &mut Counts) -> anyhow::Result<()> {
    let archive = Archive::open(db)?;
    counts.damaged += u64::from(archive.check().is_err());
    let filter = Filter {
        lot: Some(lot.to_owned()),
        ..Filter::default()
    };
    let rows = archive.query(&filter)?;
    counts.rows += rows.len() as u64;
    counts.told += told.len() as u64;
    let mut numbers: Vec<u64> = rows.iter().map(|row| row.seq).collect();
    numbers.sort_unstable();
    let in_order = numbers.iter().copied().eq(1..=numbers.len() as u64);
    counts.gaps += u64::from(!in_order);
    for part in told {
        let of_part: Vec<&Part> = rows.iter().filter(|row| part["seq"] == row.seq).collect();
        match of_part.as_slice() {
            [row] => {
                counts.other += u64::from(!same(row, part));
                counts.bare += u64::from(row.verdict == "fail" && !has_curves(&archive, row)?);
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

/// A told part lies in the bin that its row asks for, and where its landing was kept, there too.
fn same(row: &Part, told: &Value) -> bool {
    told["verdict"] == row.verdict.as_str()
        && told["bin"] == row.bin.as_deref().unwrap_or_default()
        && row
            .landed_bin
            .as_ref()
            .is_none_or(|bin| told["bin"] == bin.as_str())
}
