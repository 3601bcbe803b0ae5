//! The table at the end of a run: statistics of each parameter, verdicts, bins.

use super::output::{Fixed, bins, cells, headings};
use app::lot::Summary;
use machine::dut::{Characteristic, Kind};
use machine::handling::output::Judged;
use machine::view::LatenessView;
use quality::Spread;
use std::collections::BTreeMap;
use std::fmt::Write;

const COLUMNS: [Fixed<(&str, Spread)>; 6] = [
    ("parameter", -30, |it| it.0.to_owned()),
    ("n", 6, |it| it.1.n().to_string()),
    ("mean", 12, |it| number(it.1.mean())),
    ("sd", 12, |it| number(it.1.sd().or(Some(0.0)))),
    ("min", 12, |it| number(it.1.min())),
    ("max", 12, |it| number(it.1.max())),
];

fn number(value: Option<f64>) -> String {
    format!("{:.4}", value.unwrap_or(f64::NAN))
}

/// Values of the lot by characteristic.
#[derive(Debug, Default)]
pub struct Table {
    values: BTreeMap<Characteristic, Vec<f64>>,
}

impl Table {
    /// Adds the usable values of one part.
    pub fn add(&mut self, kind: Kind, judged: &Judged) {
        for characteristic in kind.characteristics() {
            if let Some(reading) = judged.record.usable(characteristic) {
                let values = self.values.entry(characteristic).or_default();
                values.push(reading.value);
            }
        }
    }

    /// Returns the table.
    pub fn text(&self, summary: &Summary) -> String {
        let mut text = headings(&COLUMNS) + "\n";
        for (characteristic, values) in &self.values {
            text += &cells(&(characteristic.key(), Spread::of(values)), &COLUMNS);
            text.push('\n');
        }
        let _ = writeln!(
            text,
            "\n{} parts: {} pass, {} fail, {} void   bins: {}",
            summary.parts,
            summary.pass,
            summary.fail,
            summary.void,
            bins(&summary.bins)
        );
        let bodies = match summary.bodies_watched {
            Some(false) => ", bodies: not watched",
            Some(true) | None => "",
        };
        let _ = writeln!(
            text,
            "{} parts/h, {} s of rig time in {} s, {} alarms{bodies}",
            summary.parts_per_hour, summary.elapsed_s, summary.wall_s, summary.alarms
        );
        if let Some(lateness) = &summary.lateness {
            text += &lateness_line("lateness of the cycle", lateness);
            text.push('\n');
        }
        text
    }
}

/// Returns a line with the figures of a lateness: how late the computer woke the rig.
pub fn lateness_line(name: &str, it: &LatenessView) -> String {
    format!(
        "{name}: median {:.3}, p99 {:.3}, p99.9 {:.3}, worst {:.3} ms of {} waits",
        it.p50_ms, it.p99_ms, it.p999_ms, it.worst_ms, it.waits
    )
}
