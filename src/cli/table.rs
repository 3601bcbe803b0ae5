//! Results and bins at the end of a run, for a person.

use app::lot::Summary;
use machine::dut::{Characteristic, Kind};
use machine::handling::output::Judged;
use quality::Spread;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Values of the lot by characteristic.
#[derive(Debug, Default)]
pub struct Table {
    values: BTreeMap<Characteristic, Vec<f64>>,
}

impl Table {
    /// Takes in one part of this kind.
    pub fn add(&mut self, kind: Kind, judged: &Judged) {
        for characteristic in kind.characteristics() {
            if let Some(reading) = judged.record.usable(characteristic) {
                let values = self.values.entry(characteristic).or_default();
                values.push(reading.value);
            }
        }
    }

    /// The table.
    pub fn text(&self, summary: &Summary) -> String {
        let mut text = String::new();
        let _ = writeln!(
            text,
            "{:<30} {:>6} {:>12} {:>12} {:>12} {:>12}",
            "parameter", "n", "mean", "sd", "min", "max"
        );
        for (characteristic, values) in &self.values {
            let spread = Spread::of(values);
            let low = values.iter().copied().fold(f64::INFINITY, f64::min);
            let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let _ = writeln!(
                text,
                "{:<30} {:>6} {:>12.4} {:>12.4} {:>12.4} {:>12.4}",
                characteristic.key(),
                values.len(),
                spread.mean().unwrap_or(f64::NAN),
                spread.sd().unwrap_or(0.0),
                low,
                high
            );
        }
        let bins: Vec<String> = summary
            .bins
            .iter()
            .map(|(bin, n)| format!("{bin} {n}"))
            .collect();
        let _ = writeln!(
            text,
            "\n{} parts: {} pass, {} fail, {} void   bins: {}",
            summary.parts,
            summary.pass,
            summary.fail,
            summary.void,
            bins.join(", ")
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
        text
    }
}
