//! The object that ends `run --json`.

use super::counts::Counts;
use super::rows;
use app::cycle::Profile;
use bus::LineLog;
use machine::station::wants::Ending;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::time::Duration;

/// Counts, pace and how it ended; `elapsed_s` is rig time from the first part to the last landing.
pub fn of(counts: &Counts, ending: &Ending, elapsed_s: f64, wall: Duration) -> Value {
    json!({
        "type": "summary",
        "parts": counts.parts(),
        "pass": counts.of("pass"),
        "fail": counts.of("fail"),
        "void": counts.of("void"),
        "bins": counts.bins,
        "elapsed_s": rows::rounded(elapsed_s),
        "wall_s": rows::rounded(wall.as_secs_f64()),
        "parts_per_hour": counts.per_hour(elapsed_s).unwrap_or(0.0).round() as u64,
        "alarms": counts.alarms,
        "ended": ending.name(),
    })
}

/// Where the wall time of the run went, seconds by phase.
pub fn wall_profile(profile: &Profile, writing: Duration, wall: Duration) -> Value {
    let spent = profile.scan_s + profile.step_s + profile.clear_s + profile.apply_s;
    let history_s = writing.as_secs_f64();
    let rest = (wall.as_secs_f64() - spent - history_s).max(0.0);
    json!({
        "scan": rows::rounded(profile.scan_s),
        "step": rows::rounded(profile.step_s),
        "clear": rows::rounded(profile.clear_s),
        "apply": rows::rounded(profile.apply_s),
        "history": rows::rounded(history_s),
        "bus_simulator_runtime": rows::rounded(rest),
    })
}

/// Fingerprint of everything that each line carried.
pub fn bytes(logs: &[(String, LineLog)]) -> Value {
    let bytes: BTreeMap<&str, String> = logs
        .iter()
        .map(|(name, log)| (name.as_str(), format!("{:016x}", log.fingerprint())))
        .collect();
    json!(bytes)
}
