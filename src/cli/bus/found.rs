//! Modules that a scan has found, as a table or as JSON.

use crate::cli::output::{self, Fixed, latency_ms};
use bus::{LineLog, ModuleHealth};
use dcon::{Address, Config};
use serde_json::json;

/// A module that answered.
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

    /// Returns the number of transactions without a good reply.
    fn bad(&self) -> u64 {
        let counts = self.counts();
        counts.time_outs + counts.checksum_errors + counts.other_errors
    }
}

/// Returns the modules as text: a table row each, or a JSON object each.
pub(super) fn listing(found: &[Found], as_json: bool) -> String {
    let object = as_json.then_some(object as fn(&Found) -> String);
    output::listing(found, &COLUMNS, "no module answered", object)
}

const COLUMNS: [Fixed<Found>; 12] = [
    ("addr", -4, |it| it.asked.to_string()),
    ("baud", 6, |it| it.baud.to_string()),
    ("checksum", -8, |it| on_off(it.checksum).to_owned()),
    ("name", -6, |it| it.name.clone()),
    ("firmware", -8, |it| it.firmware.clone()),
    ("type", -4, |it| format!("{:02X}", it.config.type_code.0)),
    ("format", -6, |it| format!("{:02X}", it.config.format.0)),
    ("p50 ms", 7, |it| latency(it, 0.5)),
    ("p99 ms", 7, |it| latency(it, 0.99)),
    ("asked", 5, |it| it.counts().transactions.to_string()),
    ("bad", 4, |it| it.bad().to_string()),
    (" remarks", 0, |it| format!(" {}", remarks(it).join("; "))),
];

fn object(module: &Found) -> String {
    let (counts, config) = (module.counts(), module.config);
    let object = json!({
        "address": module.asked.to_string(), "stored_address": module.stored.to_string(),
        "baud": module.baud, "checksum": module.checksum, "name": module.name,
        "firmware": module.firmware, "type": format!("{:02X}", config.type_code.0),
        "stored_baud": config.baud.rate(), "format": format!("{:02X}", config.format.0),
        "p50_ms": latency_ms(&counts.latency, 0.5), "p99_ms": latency_ms(&counts.latency, 0.99),
        "transactions": counts.transactions,
        "time_outs": counts.time_outs, "checksum_errors": counts.checksum_errors,
        "other_errors": counts.other_errors, "resets": counts.resets, "remarks": remarks(module),
    });
    object.to_string()
}

fn on_off(on: bool) -> &'static str {
    if on { "on" } else { "off" }
}

fn latency(module: &Found, share: f64) -> String {
    format!(
        "{:.2}",
        latency_ms(&module.counts().latency, share).unwrap_or(0.0)
    )
}

/// Returns remarks on a module: each setting in effect that differs from the stored one, and risky settings.
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
        let stored = on_off(module.config.format.checksum());
        remarks.push(format!("has checksum {stored} stored"));
    }
    if !module.checksum {
        remarks.push("without checksum a damaged digit is believed".to_owned());
    }
    remarks
}
