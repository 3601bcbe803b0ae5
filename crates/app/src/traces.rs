//! Writes the last traffic of every line to files when an alarm occurs; reports the health of the modules.

use bus::{LineLog, Meaning, Recorded, arrow, escaped};
use config::Plant;
use machine::view::{LineTraffic, LineView, Message, ModuleView};
use std::path::{Path, PathBuf};

/// Largest number of traces per line and run; the first alarms explain the most.
const MAX_TRACES: usize = 8;

#[derive(Debug, Clone)]
struct LineSource {
    name: String,
    baud: u32,
    checksum: bool,
    log: LineLog,
}

/// Logs of a run's lines, and the path of their trace files.
#[derive(Debug, Clone)]
pub struct Traces {
    /// Path of the history file without its extension.
    stem: PathBuf,
    sources: Vec<LineSource>,
    dumped: usize,
}

impl Traces {
    /// Collects the logs of the lines; trace files are written beside `db`.
    pub fn new(db: &Path, plant: &Plant, logs: &[(String, LineLog)]) -> Self {
        let sources = logs.iter().filter_map(|(name, log)| {
            let line = plant.wiring.line(plant.wiring.line_named(name)?);
            Some(LineSource {
                name: name.clone(),
                baud: line.baud,
                checksum: line.checksum,
                log: log.clone(),
            })
        });
        Self {
            stem: db.with_extension(""),
            sources: sources.collect(),
            dumped: 0,
        }
    }

    /// Writes the trace of every line and returns the paths. Logs a failed write; the run continues.
    pub fn dump(&mut self, at_us: i64) -> Vec<PathBuf> {
        if self.dumped >= MAX_TRACES {
            return Vec::new();
        }
        self.dumped += 1;
        let mut written = Vec::new();
        for source in &self.sources {
            let mut path = self.stem.clone().into_os_string();
            path.push(format!(".alarm-{}-{}.trace", at_us / 1000, source.name));
            let path = PathBuf::from(path);
            let trace = source.log.trace();
            let recorded = Recorded::of(&trace, &source.name, source.baud, source.checksum);
            match std::fs::write(&path, recorded.text()) {
                Ok(()) => written.push(path),
                Err(error) => tracing::error!("trace {}: {error}", path.display()),
            }
        }
        written
    }

    /// Returns the last messages of every line, at most `last` each, with their meaning.
    pub fn messages(&self, last: usize) -> Vec<LineTraffic> {
        let sources = self.sources.iter();
        sources.map(|source| messages(source, last)).collect()
    }

    /// Returns the health of the lines and their modules.
    pub fn health(&self) -> Vec<LineView> {
        self.sources.iter().map(health).collect()
    }
}

fn messages(source: &LineSource, last: usize) -> LineTraffic {
    let trace = source.log.trace();
    let all: Vec<_> = trace.entries().collect();
    let mut meaning = Meaning::new(source.checksum);
    let from = all.len().saturating_sub(last);
    let entries = all[from..].iter().map(|entry| Message {
        at_us: entry.at.0,
        way: arrow(entry.direction).to_string(),
        text: escaped(entry.bytes()),
        meaning: meaning.of(entry),
    });
    LineTraffic {
        line: source.name.clone(),
        entries: entries.collect(),
    }
}

fn health(source: &LineSource) -> LineView {
    let health = source.log.health();
    let modules = health.modules().map(|(address, module)| {
        let ms = |share| {
            let span = module.latency.percentile(share);
            span.map(|span| span.as_seconds() * 1e3)
        };
        ModuleView {
            address: address.to_string(),
            transactions: module.transactions,
            p50_ms: ms(0.5),
            p99_ms: ms(0.99),
            time_outs: module.time_outs,
            checksum_errors: module.checksum_errors,
            other_errors: module.other_errors,
            refusals: module.refusals,
            resets: module.resets,
        }
    });
    LineView {
        name: source.name.clone(),
        ports_lost: health.ports_lost,
        modules: modules.collect(),
    }
}
