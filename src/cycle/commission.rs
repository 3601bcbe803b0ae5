//! Before anything moves: every module is asked who it is and how it is set, and compared with the wiring.

use super::traffic::{Purpose, Traffic};
use crate::bus::Pace;
use crate::dcon::{Command, Common};
use crate::rig::commission::{judge, verification};
use crate::rig::wiring::Wiring;
use crate::station::trouble::Alarm;
use std::collections::BTreeMap;

/// Asks everything, line by line in parallel; the first disagreement or silent module is the alarm.
pub async fn verify(wiring: &Wiring, pace: &Pace, traffic: &mut Traffic) -> Result<(), Alarm> {
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
            let reply = answer.outcome.map_err(|error| {
                let cause = std::error::Error::source(&error)
                    .map_or_else(String::new, |cause| format!(": {cause}"));
                Alarm::bus(&format!("{error}{cause} ({} tries)", answer.tries_used))
            })?;
            if let Some(mismatch) = judge(wiring, &checks[index], &reply) {
                return Err(Alarm::bus(&mismatch.to_string()));
            }
        }
    }
    traffic.start_scan();
    Ok(())
}
