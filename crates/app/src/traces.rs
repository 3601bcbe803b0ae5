//! Writes the last traffic of every line and instrument to files when an alarm occurs; reports the health of modules
//! and instruments.

use crate::instrument_log::InstrumentLog;
use crate::links::Lines;
use crate::signals::Signals;
use crate::trace_files::{tidy, trace_path};
use bus::{LineLog, Meaning, Recorded, arrow, escaped};
use config::{HistorySettings, Plant};
use machine::rig::wiring::{LineId, Wiring};
use machine::view::{InstrumentView, LineTraffic, LineView, Message, ModuleView};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use texts::Lang;

/// Greatest number of alarms per run for which the program writes traces; the first alarms explain the most.
const MAX_TRACES: usize = 8;

#[derive(Debug, Clone)]
struct LineSource {
    name: String,
    baud: u32,
    checksum: bool,
    line: LineId,
    wiring: Arc<Wiring>,
    log: LineLog,
}

/// Logs of a run's lines and instruments, and where their trace files go.
#[derive(Debug, Clone)]
pub struct Traces {
    /// Path of the history file without its extension.
    stem: PathBuf,
    keep: HistorySettings,
    sources: Vec<LineSource>,
    instruments: Vec<InstrumentLog>,
    dumped: usize,
}

impl Traces {
    /// Collects the logs of lines and instruments, whose traces go into files beside `db`. Deletes old trace files.
    pub fn new(db: &Path, plant: &Plant, lines: &Lines) -> Self {
        let wiring = Arc::new(plant.wiring.clone());
        let sources = lines.logs.iter().filter_map(|(name, log)| {
            let id = wiring.line_named(name)?;
            let line = wiring.line(id);
            Some(LineSource {
                name: name.clone(),
                baud: line.baud,
                checksum: line.checksum,
                line: id,
                wiring: Arc::clone(&wiring),
                log: log.clone(),
            })
        });
        let stem = db.with_extension("");
        let now_ms = jiff::Timestamp::now().as_millisecond();
        tidy(&stem, &plant.history, now_ms);
        Self {
            stem,
            keep: plant.history.clone(),
            sources: sources.collect(),
            instruments: lines.instrument_logs.clone(),
            dumped: 0,
        }
    }

    /// Writes the trace of every line and instrument, then deletes old traces, and the new ones too when `[history]`
    /// keeps none. Returns the paths of the new files that remain. Writes nothing after `MAX_TRACES` calls. Logs a
    /// failed write; the run continues.
    pub fn dump(&mut self, at_us: i64) -> Vec<PathBuf> {
        if self.dumped >= MAX_TRACES {
            return Vec::new();
        }
        self.dumped += 1;
        let lines = self.sources.iter().map(|source| {
            let trace = source.log.trace();
            let recorded = Recorded::of(&trace, &source.name, source.baud, source.checksum);
            (source.name.as_str(), recorded.text())
        });
        let instruments = self.instruments.iter();
        let instruments = instruments.map(|it| (it.name.as_str(), it.text()));
        let mut written = Vec::new();
        for (name, text) in lines.chain(instruments) {
            let path = trace_path(&self.stem, at_us / 1000, name);
            match std::fs::write(&path, text) {
                Ok(()) => written.push(path),
                Err(error) => tracing::error!("trace {}: {error}", path.display()),
            }
        }
        tidy(&self.stem, &self.keep, at_us / 1000);
        written.retain(|path| path.exists());
        written
    }

    /// Returns the last messages of every line, with their meaning, then those of every instrument; at most `last`
    /// each.
    pub fn messages(&self, last: usize) -> Vec<LineTraffic> {
        let sources = self.sources.iter();
        let lines = sources.map(|source| messages(source, last));
        let instruments = self.instruments.iter().map(|it| it.messages(last));
        lines.chain(instruments).collect()
    }

    /// Returns the health of the instruments.
    pub fn instruments(&self) -> Vec<InstrumentView> {
        self.instruments.iter().map(InstrumentLog::health).collect()
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
    let mut signals = Signals::new(&source.wiring, source.line);
    let from = all.len().saturating_sub(last);
    let entries = all[from..].iter().map(|entry| {
        let [english, chinese] = meaning.of(entry, [Lang::En, Lang::Zh]);
        Message {
            at_us: entry.at.0,
            way: arrow(entry.direction).to_string(),
            text: escaped(entry.bytes()),
            meaning: english,
            meaning_zh: chinese,
            signals: signals.of(entry),
        }
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
