//! What a scan has found, as a table or as objects.

use bus::{LineLog, ModuleHealth};
use dcon::{Address, Config};
use serde_json::json;

/// A module that has answered.
pub(super) struct Found {
    pub(super) asked: Address,
    pub(super) stored: Address,
    pub(super) baud: u32,
    pub(super) checksum: bool,
    pub(super) config: Config,
    pub(super) name: String,
    pub(super) firmware: String,
    pub(super) log: LineLog,
}

impl Found {
    fn counts(&self) -> ModuleHealth {
        let health = self.log.health();
        health.module(self.asked).cloned().unwrap_or_default()
    }
}

/// A row or an object per module.
pub(super) fn told(found: &[Found], as_json: bool) -> String {
    let rows = found.iter().map(|module| match as_json {
        true => object(module),
        false => row(module),
    });
    let head = format!(
        "{:<4} {:>6} {:<8} {:<6} {:<8} {:<4} {:<6} {:>7} {:>7} {:>5} {:>4}  remarks",
        "addr",
        "baud",
        "checksum",
        "name",
        "firmware",
        "type",
        "format",
        "p50 ms",
        "p99 ms",
        "asked",
        "bad"
    );
    match (found.is_empty(), as_json) {
        (true, true) => String::new(),
        (true, false) => "nobody answered\n".to_owned(),
        (false, true) => rows.map(|row| row + "\n").collect(),
        (false, false) => std::iter::once(head)
            .chain(rows)
            .map(|row| row + "\n")
            .collect(),
    }
}

fn object(module: &Found) -> String {
    let (counts, config) = (module.counts(), module.config);
    let object = json!({
        "address": module.asked.to_string(), "stored_address": module.stored.to_string(),
        "baud": module.baud, "checksum": module.checksum, "name": module.name,
        "firmware": module.firmware, "type": format!("{:02X}", config.type_code.0),
        "stored_baud": config.baud.rate(), "format": format!("{:02X}", config.format.0),
        "p50_ms": ms(&counts, 0.5), "p99_ms": ms(&counts, 0.99), "transactions": counts.transactions,
        "time_outs": counts.time_outs, "checksum_errors": counts.checksum_errors,
        "other_errors": counts.other_errors, "resets": counts.resets, "remarks": remarks(module),
    });
    object.to_string()
}

fn row(module: &Found) -> String {
    let (counts, config) = (module.counts(), module.config);
    let bad = counts.time_outs + counts.checksum_errors + counts.other_errors;
    format!(
        "{:<4} {:>6} {:<8} {:<6} {:<8} {:<4} {:<6} {:>7.2} {:>7.2} {:>5} {:>4}  {}",
        module.asked.to_string(),
        module.baud,
        if module.checksum { "on" } else { "off" },
        module.name,
        module.firmware,
        format!("{:02X}", config.type_code.0),
        format!("{:02X}", config.format.0),
        ms(&counts, 0.5).unwrap_or(0.0),
        ms(&counts, 0.99).unwrap_or(0.0),
        counts.transactions,
        bad,
        remarks(module).join("; ")
    )
}

/// Latency that this share of the answers did not exceed.
fn ms(counts: &ModuleHealth, share: f64) -> Option<f64> {
    let span = counts.latency.percentile(share)?;
    Some(span.as_seconds() * 1e3)
}

/// What differs between how the module was found and what it has stored.
fn remarks(module: &Found) -> Vec<String> {
    let mut remarks = Vec::new();
    if module.stored != module.asked {
        remarks.push(format!("INIT* mode, stored address {}", module.stored));
    }
    if let Some(stored) = module
        .config
        .baud
        .rate()
        .filter(|rate| *rate != module.baud)
    {
        remarks.push(format!("has {stored} baud stored"));
    }
    if module.config.format.checksum() != module.checksum {
        let stored = if module.config.format.checksum() {
            "on"
        } else {
            "off"
        };
        remarks.push(format!("has checksum {stored} stored"));
    }
    if !module.checksum {
        remarks.push("without checksum a damaged digit is believed".to_owned());
    }
    remarks
}
