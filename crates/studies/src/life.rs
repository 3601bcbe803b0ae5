//! Memory, open files and rows of `serve` over many lots. The study orders the lots one after another, as a person does
//! on the page.
//!
//! The program runs in a process of its own. The first parts fill caches and buffers; after them, memory and open files
//! must not grow. Every ordered part must have one row.

use super::chart::Chart;
use super::figure::{Bar, Figure, percent};
use super::order::{Order, memory_kb};
use super::output::Report;
use anyhow::{Context, bail, ensure};
use app::progress::{PIECES, progress};
use history::{Archive, Filter};
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Parts that fill caches and buffers: growth counts from the end of the lot that completes them.
const WARM_PARTS: u64 = 2_000;
/// Greatest growth of the resident memory after these parts, percent.
const GROWTH_PCT: f64 = 1.0;
/// Pause between two polls of the view.
const LOOK: Duration = Duration::from_millis(100);
/// Number of reads of the open files at the end of a lot.
const LOOKS: u32 = 10;
/// Longest wait for a state of the machine.
const STATE_TIMEOUT: Duration = Duration::from_secs(120);
/// Longest wait per part of a lot.
const PART_TIMEOUT: Duration = Duration::from_secs(10);

/// Memory and open files of the program.
#[derive(Debug, Clone, Copy)]
struct Footprint {
    /// Resident memory, kB.
    resident_kb: u64,
    /// Open files, with the sockets that stay open.
    files: u64,
}

/// Returns the number of lots that complete the first [`WARM_PARTS`] parts.
fn warm_lots(order: &Order) -> usize {
    WARM_PARTS.div_ceil(order.parts.max(1)) as usize
}

/// Runs the lots of the order in one program and makes the report.
///
/// # Errors
/// Fails when no lot follows the first [`WARM_PARTS`] parts, or when the program does not start, refuses an order, raises
/// an alarm that ends a lot, or shows no progress.
pub fn study(order: &Order) -> anyhow::Result<Report> {
    let warm = warm_lots(order);
    ensure!(
        order.lots > warm as u64,
        "--seeds {} has no lot after the first {WARM_PARTS} parts: expected at least {} lots of {} parts",
        order.lots,
        warm + 1,
        order.parts
    );
    let folder = TempDir::new()?;
    let db = folder.path().join("history.db");
    let mut served = Served::start(order, &db)?;
    let bar = progress(Some(order.lots), PIECES);
    let mut footprints = Vec::new();
    for lot in 0..order.lots {
        served.run_lot(order, &format!("L{lot}"))?;
        footprints.push(footprint(served.process.id())?);
        bar.inc(1);
    }
    bar.finish_and_clear();
    drop(served);
    Ok(report(order, &footprints, rows(&db)?))
}

fn report(order: &Order, footprints: &[Footprint], rows: u64) -> Report {
    let ordered = order.lots * order.parts;
    let after = footprints.get(warm_lots(order) - 1..).unwrap_or_default();
    let grown = |of: fn(&Footprint) -> u64| {
        let first = after.first().map(of)?;
        let most = after.iter().map(of).max()?;
        Some((first, most - first))
    };
    let memory = grown(|it| it.resident_kb);
    let files = grown(|it| it.files);
    let mb: Vec<f64> = footprints
        .iter()
        .map(|it| it.resident_kb as f64 / 1024.0)
        .collect();
    let bars = vec![
        Figure::new(
            "growth of the memory after the first 2,000 parts",
            ordered,
            memory.and_then(|(first, grown)| percent(grown, first)),
            "%",
        )
        .with("first_mb", mb.get(warm_lots(order) - 1).copied())
        .with("last_mb", mb.last().copied())
        .bar(Bar::AtMost(GROWTH_PCT)),
        Figure::none(
            "open files more than after the first 2,000 parts",
            ordered,
            files.map_or(u64::MAX, |(_, grown)| grown),
        ),
        Figure::none(
            "ordered parts without a row",
            ordered,
            ordered.saturating_sub(rows),
        ),
        Figure::none(
            "rows beyond the ordered parts",
            ordered,
            rows.saturating_sub(ordered),
        ),
    ];
    let spread = quality::Ordered::of(&mb);
    let quartiles = [0.0, 0.5, 1.0].map(|p| (format!("{p} of the lots up to"), spread.quantile(p)));
    let chart = Chart::new(
        "resident memory at the end of a lot",
        "MB",
        Vec::new(),
        quartiles,
    );
    Report::new("life", order.about(), vec![bars], chart)
}

/// Counts the parts of all lots in the history.
fn rows(db: &Path) -> anyhow::Result<u64> {
    let runs = Archive::open(db)?.lots(&Filter::default())?;
    Ok(runs.iter().map(|it| it.counts.parts).sum())
}

/// Reads the memory, and the least number of open files within a second: the program closes the socket of an answered
/// request a moment after the answer.
fn footprint(process: u32) -> anyhow::Result<Footprint> {
    let mut files = u64::MAX;
    for _ in 0..LOOKS {
        let open = std::fs::read_dir(format!("/proc/{process}/fd"))?;
        files = files.min(open.count() as u64);
        std::thread::sleep(LOOK);
    }
    let resident_kb = memory_kb(process, "VmRSS");
    Ok(Footprint {
        resident_kb: resident_kb.context("/proc/PID/status has no VmRSS")?,
        files,
    })
}

/// A running `serve` process, and the session of an engineer on its page.
struct Served {
    process: Child,
    address: String,
    token: String,
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

impl Served {
    /// Starts the program and sets up its first user with the set-up code that a first start prints.
    fn start(order: &Order, db: &Path) -> anyhow::Result<Self> {
        let mut command = order.command(db, "info");
        command.args([
            "serve",
            "--sim",
            "--speed",
            "1000",
            "--listen",
            "127.0.0.1:0",
        ]);
        command.stdout(Stdio::null()).stderr(Stdio::piped());
        let mut process = command.spawn().context("starting serve")?;
        let log = process.stderr.take().context("the log of serve")?;
        let mut served = Self {
            process,
            address: String::new(),
            token: String::new(),
        };
        let mut log = BufReader::new(log);
        let mut text = String::new();
        let after = |text: &str, before: &str, end: char| {
            let (_, rest) = text.split_once(before)?;
            rest.split_once(end).map(|(word, _)| word.to_owned())
        };
        served.address = loop {
            ensure!(log.read_line(&mut text)? > 0, "serve ended: {text}");
            if let Some(address) = after(&text, "page at http://", '/') {
                break address;
            }
        };
        std::thread::spawn(move || std::io::copy(&mut log, &mut std::io::sink()));
        let code = after(&text, "set-up code ", ',').context("no set-up code")?;
        let engineer = json!({"code": code, "user": "engineer", "password": "of this study"});
        let session = served.ask("POST /api/setup", &engineer)?;
        served.token = session["token"].as_str().context("no session")?.to_owned();
        Ok(served)
    }

    /// Sends a request and returns the answer.
    fn ask(&self, request: &str, body: &Value) -> anyhow::Result<Value> {
        let mut stream = TcpStream::connect(&self.address)?;
        let body = body.to_string();
        write!(
            stream,
            "{request} HTTP/1.1\r\nHost: {}\r\nConnection: close\r\nContent-Type: application/json\r\n\
             Authorization: Bearer {}\r\nContent-Length: {}\r\n\r\n{body}",
            self.address,
            self.token,
            body.len()
        )?;
        let mut answer = String::new();
        stream.read_to_string(&mut answer)?;
        let (head, body) = answer.split_once("\r\n\r\n").context("half an answer")?;
        ensure!(head.contains(" 200 "), "{request}: {body}");
        Ok(serde_json::from_str(body)?)
    }

    fn run_lot(&mut self, order: &Order, lot: &str) -> anyhow::Result<()> {
        let state = |view: &Value| {
            view["machine"]["state"]
                .as_str()
                .unwrap_or_default()
                .to_owned()
        };
        let rests = |view: &Value| ["Stopped", "Complete", "Idle"].contains(&state(view).as_str());
        let view = self.until(STATE_TIMEOUT, rests)?;
        if state(&view) != "Idle" {
            self.ask("POST /api/orders", &json!({"order": "reset"}))?;
            self.until(STATE_TIMEOUT, |view| state(view) == "Idle")?;
        }
        let recipe = &order.recipe.name;
        let start = json!({"order": "start", "lot": lot, "recipe": recipe, "count": order.parts});
        self.ask("POST /api/orders", &start)?;
        let parts = u32::try_from(order.parts)?;
        let ended = |view: &Value| view["last_run"]["lot"] == lot;
        let view = self.until(STATE_TIMEOUT + PART_TIMEOUT * parts, ended)?;
        let run = &view["last_run"];
        ensure!(run["ended"] == "complete", "lot {lot}: {run}");
        Ok(())
    }

    /// Polls the view until it passes `test`; fails after `timeout`.
    fn until(&mut self, timeout: Duration, test: impl Fn(&Value) -> bool) -> anyhow::Result<Value> {
        let began = Instant::now();
        while began.elapsed() < timeout {
            let view = self.ask("GET /api/view", &Value::Null)?;
            if test(&view) {
                return Ok(view);
            }
            if let Some(status) = self.process.try_wait()? {
                bail!("serve ended with {status}");
            }
            std::thread::sleep(LOOK);
        }
        bail!("no progress for {} s", timeout.as_secs())
    }
}
