//! Summary of a run: the last object that `run --json` prints.

use super::counts::Counts;
use super::rows::rounded;
use crate::exit::Cause;
use bus::LineLog;
use cycle::Profile;
use machine::dut::promise::Broken;
use machine::station::turn::Ending;
use machine::view::LatenessView;
use serde::Serialize;
use std::collections::BTreeMap;
use std::time::Duration;

/// Counts, pace and end of a run.
#[derive(Debug, Clone, Serialize)]
pub struct Summary {
    /// Always `summary`.
    #[serde(rename = "type")]
    kind: &'static str,
    /// Judged parts of the lot.
    pub parts: u64,
    /// Parts that passed.
    pub pass: u64,
    /// Parts that failed.
    pub fail: u64,
    /// Parts that could not be judged.
    pub void: u64,
    /// Parts of the lot that the beam of a bin has seen, by bin.
    pub bins: BTreeMap<String, u64>,
    /// Rig time from the beginning of the lot to the last landing, seconds.
    pub elapsed_s: f64,
    /// Wall time of the run, seconds.
    pub wall_s: f64,
    /// Judged parts per hour of rig time, rounded.
    pub parts_per_hour: u64,
    /// Number of alarms.
    pub alarms: u64,
    /// How the run ended: `complete`, `stopped` or `alarm`.
    pub ended: &'static str,
    /// Cause of exit status 3; null for every other status.
    pub cause: Option<Cause>,
    /// EEPROM writes of all modules since the lot began; absent on a real rig, whose modules keep no count.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub eeprom_writes: Option<u64>,
    /// True when the simulated rig checks bodies for contact; absent on a real rig.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bodies_watched: Option<bool>,
    /// Promises of rig and recipe (standard deviations that uncertainty budgets use) that did not hold.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub broken_promises: Vec<BrokenPromise>,
    /// How late this computer woke the cycle; absent in virtual time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lateness: Option<LatenessView>,
    /// Wall time by phase of the control cycle.
    pub wall_profile: WallProfile,
    /// Fingerprint of all bytes that passed on each line, by the name of the line.
    pub bytes: BTreeMap<String, String>,
}

impl Summary {
    pub(super) fn new(
        counts: &Counts,
        (ending, cause): (&Ending, Option<&Cause>),
        elapsed_s: f64,
        wall: Duration,
        logs: &[(String, LineLog)],
    ) -> Self {
        let fingerprint = |log: &LineLog| format!("{:016x}", log.fingerprint());
        Self {
            kind: "summary",
            parts: counts.parts(),
            pass: counts.of("pass"),
            fail: counts.of("fail"),
            void: counts.of("void"),
            bins: counts.bins.clone(),
            elapsed_s: rounded(elapsed_s),
            wall_s: rounded(wall.as_secs_f64()),
            parts_per_hour: counts.per_hour(elapsed_s).unwrap_or(0.0).round() as u64,
            alarms: counts.alarms,
            ended: ending.name(),
            cause: cause.cloned(),
            eeprom_writes: None,
            bodies_watched: None,
            broken_promises: Vec::new(),
            lateness: None,
            wall_profile: WallProfile::default(),
            bytes: logs
                .iter()
                .map(|(name, log)| (name.clone(), fingerprint(log)))
                .collect(),
        }
    }
}

/// A promise that did not hold, and the number of parts judged before the rig noticed.
#[derive(Debug, Clone, Serialize)]
pub struct BrokenPromise {
    /// Number of parts of the lot that were judged with the promised value.
    pub after_parts: u64,
    /// The disproved standard deviation: as `rig.toml` or the recipe states it, as observed, and as the uncertainty
    /// budgets of later parts use it.
    #[serde(flatten)]
    pub broken: Broken,
}

/// Wall time of a run by phase, seconds.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub struct WallProfile {
    scan: f64,
    step: f64,
    clear: f64,
    apply: f64,
    history: f64,
    bus_simulator_runtime: f64,
}

impl WallProfile {
    pub(super) fn new(profile: &Profile, writing: Duration, wall: Duration) -> Self {
        let spent = profile.scan_s + profile.step_s + profile.clear_s + profile.apply_s;
        let history_s = writing.as_secs_f64();
        let rest = (wall.as_secs_f64() - spent - history_s).max(0.0);
        Self {
            scan: rounded(profile.scan_s),
            step: rounded(profile.step_s),
            clear: rounded(profile.clear_s),
            apply: rounded(profile.apply_s),
            history: rounded(history_s),
            bus_simulator_runtime: rounded(rest),
        }
    }
}
