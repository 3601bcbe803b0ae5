//! A run at the terminal: progress bar and alarms on stderr; rows, table or summary on stdout.

use super::table::Table;
use app::exit::Exit;
use app::lot::{LotEvent, LotProgress, Subscriber, part_json};
use app::progress::progress;
use cycle::Event;
use indicatif::ProgressBar;
use machine::handling::ledger::PartRole;
use machine::handling::output::Judged;
use std::io::Write;
use texts::Lang;

/// Output on stdout.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rows {
    /// No output.
    None,
    /// A table when the run is over.
    Table,
    /// A JSON object per part, then the summary.
    Json,
}

/// Prints the events of runs, one run after another.
pub struct Terminal {
    rows: Rows,
    bar: ProgressBar,
    table: Table,
    /// True once a printed summary named the cause of trouble.
    cause_printed: bool,
}

impl Terminal {
    /// Creates a subscriber that logs alarms, shows progress on a terminal and prints `rows`.
    pub fn new(rows: Rows) -> Self {
        Self {
            rows,
            bar: ProgressBar::hidden(),
            table: Table::default(),
            cause_printed: false,
        }
    }

    /// With [`Rows::Json`], prints the cause of trouble unless a summary has named it: the trouble may come before or
    /// after the summary.
    pub fn ended(&self, exit: &Exit) {
        if let (Rows::Json, false, Some(cause)) = (self.rows, self.cause_printed, exit.cause()) {
            let it = serde_json::json!({"type": "trouble", "cause": cause});
            self.print(&format!("{it}\n"));
        }
    }

    /// Creates a subscriber that prints nothing on stdout.
    pub fn quiet() -> Self {
        Self::new(Rows::None)
    }

    fn begun(&mut self, lot: &LotProgress) {
        self.bar = match lot.context.purpose.is_between_lots() {
            true => ProgressBar::hidden(),
            false => progress(lot.context.order.count, "{bar:30} {pos}/{len} {msg}"),
        };
        self.table = Table::default();
        self.cause_printed = false;
    }

    fn judged(&mut self, judged: &Judged, lot: &LotProgress) {
        self.table.add(lot.context.recipe.device.kind(), judged);
        if !lot.context.purpose.is_between_lots() {
            self.bar.set_position(lot.counts.parts());
            let pace = lot.counts.pace_and_yield(lot.per_hour(judged.at));
            self.bar.set_message(pace);
        }
    }

    /// Prints above the progress bar; a closed pipe does not stop production.
    fn print(&self, text: &str) {
        self.bar
            .suspend(|| std::io::stdout().write_all(text.as_bytes()).ok());
    }
}

impl Subscriber for Terminal {
    fn receive(&mut self, event: &LotEvent, lot: &LotProgress<'_>) {
        let rows = match lot.context.purpose.is_between_lots() {
            true => Rows::None,
            false => self.rows,
        };
        match event {
            LotEvent::Begun => self.begun(lot),
            LotEvent::Cycle(Event::Judged(it)) if matches!(it.part.role, PartRole::Lot(_)) => {
                self.judged(it, lot);
            }
            LotEvent::Cycle(Event::Alarm(alarm, _)) => self
                .bar
                .suspend(|| tracing::error!(code = alarm.code.name(), "{}", alarm.text(Lang::En))),
            LotEvent::TracesKept(files) => self.bar.suspend(|| {
                for path in files {
                    tracing::error!("last traffic: {}", path.display());
                }
            }),
            LotEvent::PartDone(part, landed) if rows == Rows::Json => {
                if matches!(part.judged.part.role, PartRole::Lot(_)) {
                    let bin = landed.as_ref().map_or("", |it| it.bin.name());
                    let json = part_json(&lot.context, &part.judged, part.cycle_s, bin);
                    self.print(&format!("{json}\n"));
                }
            }
            LotEvent::Ended(summary) => {
                if rows == Rows::Json {
                    self.print(&format!("{}\n", serde_json::json!(summary)));
                }
                self.cause_printed = summary.cause.is_some();
                self.bar.finish_and_clear();
                if rows == Rows::Table {
                    self.print(&self.table.text(summary));
                }
            }
            LotEvent::Cycle(_) | LotEvent::PartDone(..) => {}
        }
    }
}
