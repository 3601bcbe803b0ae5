//! Measures how fast the program sends a history to a database, compared with `psql`, the plain client of the server.

use super::super::figure::{Bar, Figure};
use super::{timed, wait};
use anyhow::Context;
use config::FleetSettings;
use fleet::trial::{Trial, done};
use fleet::{push, set_up};
use history::outbox::Outbox;
use history::{LotRecord, MeasurementRecord, PartRecord, Row, Store, snapshot_hash};
use quality::Ordered;
use std::path::Path;
use tokio::runtime::Runtime;

/// Number of measurements of a part.
const VALUES: usize = 24;
/// Number of parts that a rig tests in a week.
const WEEK: f64 = 300_000.0;
/// Number of parts written one by one.
const SINGLE: u64 = 300;
/// Time of a cycle of the rig, ms.
const CYCLE_MS: f64 = 1440.0;
const BEGIN_US: i64 = 1_790_000_000_000_000;

/// Makes the figures.
pub(super) fn figures(
    server: &Trial,
    runtime: &Runtime,
    parts: u64,
) -> anyhow::Result<Vec<Figure>> {
    let folder = tempfile::tempdir()?;
    let db = folder.path().join("history.db");
    let target = server.owner();
    wait(runtime, set_up(&target))?;
    let before = one_by_one(&db, "without", SINGLE)?;
    let mut outbox = Outbox::open(&db)?;
    outbox.target(&target.url)?;
    let with = one_by_one(&db, "with", SINGLE)?;
    filled(&db, parts)?;
    let settings = FleetSettings {
        site: "study".to_owned(),
        rig: "rig-1".to_owned(),
        targets: vec![target.clone()],
        ..FleetSettings::default()
    };
    let cpu = cpu_s()?;
    let (pushed, seconds) =
        timed(|| wait(runtime, push(&mut outbox, &settings, &target, || false)));
    let (sent, cpu_ms) = (pushed?.parts, 1e3 * (cpu_s()? - cpu));
    let plain_s = plain(server, folder.path())?;
    let per_s = sent as f64 / seconds;
    let queued = Ordered::of(&with)
        .quantile(0.5)
        .zip(Ordered::of(&before).quantile(0.5));
    let share = |ms: f64| 100.0 * ms / CYCLE_MS;
    Ok(vec![
        Figure::new("parts sent, 24 measurements each", sent, Some(per_s), "/s")
            .bar(Bar::AtLeast(5_000.0)),
        Figure::new(
            "time over that of a plain copy by psql",
            sent,
            Some(seconds / plain_s),
            "",
        )
        .with("plain_s", Some(plain_s)),
        Figure::new(
            "a week off-line, at this rate",
            sent,
            Some(WEEK / per_s),
            "s",
        )
        .bar(Bar::AtMost(120.0)),
        Figure::new(
            "processor time of sending a part, of a cycle",
            sent,
            Some(share(cpu_ms / sent as f64)),
            "%",
        )
        .bar(Bar::AtMost(1.0)),
        Figure::new(
            "queueing a part, of a cycle",
            SINGLE,
            queued.map(|(with, before)| share(with - before)),
            "%",
        )
        .bar(Bar::AtMost(1.0)),
    ])
}

fn part(lot: &str, seq: u64) -> PartRecord {
    let measured = |n: usize| MeasurementRecord {
        key: format!("value_{n}_v"),
        value: Some(7.0 + (seq * 7919 % 1000) as f64 / 1000.0 + n as f64),
        uncertainty: Some(0.021),
        high: Some(40.0),
        verdict: "pass".to_owned(),
        attempt: 1,
        budget: Some("{\"gain\":0.006,\"noise\":0.004,\"temperature\":0.003}".to_owned()),
        ..MeasurementRecord::default()
    };
    PartRecord {
        lot: lot.to_owned(),
        seq,
        serial: Some(format!("{lot}-{seq:07}")),
        verdict: "pass".to_owned(),
        bin: "pass".to_owned(),
        judged_at_us: BEGIN_US + 1_440_000 * seq.cast_signed(),
        test_s: 0.74,
        kind: "lot".to_owned(),
        measurements: (0..VALUES).map(measured).collect(),
        ..PartRecord::default()
    }
}

fn begun(db: &Path, lot: &str) -> anyhow::Result<Store> {
    let mut store = Store::open(db)?;
    store.begin_lot(&LotRecord {
        lot: lot.to_owned(),
        recipe: "study".to_owned(),
        recipe_hash: snapshot_hash("study"),
        recipe_snapshot: "study".to_owned(),
        opened_at_us: BEGIN_US,
        ..LotRecord::default()
    })?;
    Ok(store)
}

/// Writes parts as a rig does, each in its own transaction; returns the time of each, ms.
fn one_by_one(db: &Path, lot: &str, count: u64) -> anyhow::Result<Vec<f64>> {
    let mut store = begun(db, lot)?;
    let mut times = Vec::new();
    for seq in 1..=count {
        let row = [Row::Part(part(lot, seq))];
        let (written, seconds) = timed(|| store.record(&row));
        written?;
        times.push(1e3 * seconds);
    }
    Ok(times)
}

/// Writes a lot of many parts at once.
fn filled(db: &Path, parts: u64) -> anyhow::Result<()> {
    let mut store = begun(db, "many")?;
    for from in (0..parts).step_by(1000) {
        let rows = (from + 1..=parts.min(from + 1000)).map(|seq| Row::Part(part("many", seq)));
        store.record(&rows.collect::<Vec<_>>())?;
    }
    Ok(())
}

/// Returns the seconds that psql takes to copy the same parts and measurements into tables without an index.
fn plain(server: &Trial, folder: &Path) -> anyhow::Result<f64> {
    let psql = |commands: &[String]| {
        let mut command = server.client("psql");
        command.args(["-q", "-v", "ON_ERROR_STOP=1", "-d", "relayrig"]);
        commands.iter().for_each(|it| {
            command.args(["-c", it]);
        });
        done(&mut command).context("running psql")
    };
    let tables = ["part", "measurement"];
    let file = |table: &str| {
        format!(
            "/tmp/{}-{table}.rows",
            folder
                .file_name()
                .map_or_else(String::new, |it| it.to_string_lossy().into_owned())
        )
    };
    let made =
        tables.map(|it| format!("CREATE TABLE plain_{it} AS SELECT * FROM relayrig.{it} LIMIT 0"));
    let out = tables.map(|it| {
        format!(
            "\\copy (SELECT * FROM relayrig.{it}) TO '{}' BINARY",
            file(it)
        )
    });
    psql(&made)?;
    psql(&out)?;
    let copied = tables.map(|it| format!("\\copy plain_{it} FROM '{}' BINARY", file(it)));
    let (copied, seconds) = timed(|| psql(&copied));
    copied?;
    let gone = tables.map(|it| format!("\\! rm {}", file(it)));
    psql(&gone)?;
    Ok(seconds)
}

/// Returns the processor time that this program has used, seconds.
fn cpu_s() -> anyhow::Result<f64> {
    /// Clock ticks per second in `/proc`, on every Linux.
    const TICKS: f64 = 100.0;
    let stat = std::fs::read_to_string("/proc/self/stat")?;
    let fields = stat.rsplit_once(')').map_or("", |(_, fields)| fields);
    let ticks = fields.split_whitespace().skip(11).take(2);
    Ok(ticks.filter_map(|it| it.parse::<f64>().ok()).sum::<f64>() / TICKS)
}
