//! Before anything moves: every module is asked who it is and how it is set, and compared with the wiring. Nobody
//! waits for an emergency stop yet, so that a question is tried as often as the bus settings allow, on every line.

use super::traffic::{Purpose, Traffic};
use crate::bus::Pace;
use crate::dcon::{Command, Common};
use crate::rig::commission::{judge, verification};
use crate::rig::wiring::{ModuleId, Wiring};
use crate::station::trouble::Alarm;
use std::collections::BTreeMap;

/// Asks everything, line by line in parallel; the first disagreement or silent module is the alarm. A module
/// whose host watchdog has tripped stands at its safe outputs and has switched its watchdog off: it is made ready
/// again, which writes to its EEPROM, and told.
pub async fn verify(
    wiring: &Wiring,
    pace: &Pace,
    traffic: &mut Traffic,
) -> Result<Vec<Alarm>, Alarm> {
    let tripped = ask(wiring, pace, traffic).await?;
    if tripped.is_empty() {
        traffic.start_scan();
        return Ok(Vec::new());
    }
    for module in &tripped {
        make_ready(wiring, pace, traffic, *module).await?;
    }
    let still = ask(wiring, pace, traffic).await?;
    traffic.start_scan();
    let named = |module: &ModuleId| wiring.module(*module).name.clone();
    match still.first() {
        Some(module) => Err(Alarm::bus(&format!("{} stays tripped", named(module)))),
        None => {
            let names: Vec<String> = tripped.iter().map(named).collect();
            Ok(vec![Alarm::watchdog_tripped(&names.join(", "))])
        }
    }
}

/// Clears the trip of one module and switches its watchdog on again.
async fn make_ready(
    wiring: &Wiring,
    pace: &Pace,
    traffic: &mut Traffic,
    module: ModuleId,
) -> Result<(), Alarm> {
    let wired = wiring.module(module);
    let enable = Common::WriteWatchdog {
        enabled: wired.watchdog,
        timeout_tenths: (wiring.bus.host_watchdog_ms / 100.0).round() as u8,
    };
    for command in [Common::ClearWatchdogStatus, enable] {
        traffic.queue(wired.line, command.to(wired.address), Purpose::Check);
        loop {
            traffic.dispatch(pace.now());
            traffic.answer().await;
            let answer = traffic.next_answer();
            if let Some((_, Purpose::Check, answer)) = answer {
                answer
                    .outcome
                    .map_err(|error| Alarm::bus(&error.to_string()))?;
                break;
            }
        }
    }
    Ok(())
}

/// Every question once; the modules whose host watchdog has tripped.
async fn ask(wiring: &Wiring, pace: &Pace, traffic: &mut Traffic) -> Result<Vec<ModuleId>, Alarm> {
    let mut tripped = Vec::new();
    let checks = verification(wiring);
    let mut pending = BTreeMap::new();
    for (index, check) in checks.iter().enumerate() {
        let line = wiring.module(check.module).line;
        traffic.queue(line, check.command, Purpose::Check);
        pending.entry(line.0).or_insert_with(Vec::new).push(index);
    }
    for order in pending.values_mut() {
        order.reverse();
    }
    let mut left = checks.len();
    while left > 0 {
        traffic.dispatch(pace.now());
        traffic.answer().await;
        while let Some((line, purpose, answer)) = traffic.next_answer() {
            if purpose != Purpose::Check {
                continue;
            }
            left -= 1;
            let Some(index) = pending.get_mut(&line.0).and_then(Vec::pop) else {
                continue;
            };
            let lost_status = matches!(answer.command, Command::Common(_, Common::ReadResetStatus));
            if lost_status && answer.outcome.is_err() {
                continue;
            }
            let reply = answer
                .outcome
                .map_err(|error| Alarm::bus(&format!("{error} ({} tries)", answer.tries_used)))?;
            let check = &checks[index];
            if let Some(mismatch) = judge(wiring, check, &reply) {
                if mismatch.what == "host watchdog" {
                    if !tripped.contains(&check.module) {
                        tripped.push(check.module);
                    }
                    continue;
                }
                return Err(Alarm::bus(&mismatch.to_string()));
            }
        }
    }
    Ok(tripped)
}
