//! Compares the name and the settings of every module with the wiring, before anything moves. The outputs are still
//! safe, so no emergency stop has to be seen in time, and a request may be repeated as often as the bus settings allow.

use super::traffic::{Purpose, Traffic};
use bus::Pace;
use dcon::{Command, Common};
use machine::dut;
use machine::rig::commission::{Mismatch, judge, verification};
use machine::rig::wiring::{ModuleId, Wiring};
use machine::station::trouble::Alarm;
use std::collections::BTreeMap;

/// A setting that an interrupted run of the controller left in a module.
struct Leftover {
    module: ModuleId,
    what: Setting,
    /// Commands that restore the setting; they write to the module's EEPROM.
    remedies: Vec<Command>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Setting {
    /// The host watchdog has tripped: the outputs are at their safe values and the watchdog is off.
    Tripped,
    /// The analog input module still reads only the channels of the references.
    Masked,
}

/// Reads all settings, on all lines in parallel; returns the first mismatch or the first silent module as an alarm.
/// Restores the settings that an interrupted run of the controller left behind, and logs each.
pub async fn verify(
    wiring: &Wiring,
    pace: &Pace,
    traffic: &mut Traffic,
) -> Result<Vec<Alarm>, Alarm> {
    let left = ask(wiring, pace, traffic).await?;
    if left.is_empty() {
        traffic.start_scan();
        return Ok(Vec::new());
    }
    for one in &left {
        restore(wiring, pace, traffic, one).await?;
    }
    let still = ask(wiring, pace, traffic).await?;
    traffic.start_scan();
    let name = |one: &Leftover| wiring.module(one.module).name.clone();
    if let Some(one) = still.first() {
        let what = match one.what {
            Setting::Tripped => "tripped",
            Setting::Masked => "masked",
        };
        return Err(Alarm::bus(&format!("{} is still {what}", name(one))));
    }
    let names = |what: Setting| {
        let those: Vec<String> = left.iter().filter(|it| it.what == what).map(name).collect();
        (!those.is_empty()).then(|| those.join(", "))
    };
    let tripped = names(Setting::Tripped).map(|names| Alarm::watchdog_tripped(&names));
    let masked = names(Setting::Masked).map(|names| Alarm::calibration_cut_off(&names));
    Ok(tripped.into_iter().chain(masked).collect())
}

async fn restore(
    wiring: &Wiring,
    pace: &Pace,
    traffic: &mut Traffic,
    left: &Leftover,
) -> Result<(), Alarm> {
    for command in &left.remedies {
        let line = wiring.module(left.module).line;
        traffic.queue(line, *command, Purpose::Check);
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

/// Returns the leftover that explains a mismatch; `None` when the controller did not cause the mismatch.
fn leftover(wiring: &Wiring, module: ModuleId, mismatch: &Mismatch) -> Option<Leftover> {
    let wired = wiring.module(module);
    let of_references = wiring.mask_of(module, &dut::reference_inputs(wiring));
    let masked = of_references != 0 && mismatch.found == format!("{of_references:02X}");
    let (what, remedies) = if mismatch.what == "host watchdog" {
        let enable = Common::WriteWatchdog {
            enabled: wired.watchdog,
            timeout_tenths: (wiring.bus.host_watchdog_ms / 100.0).round() as u8,
        };
        let both = [Common::ClearWatchdogStatus, enable];
        (Setting::Tripped, both.map(|it| it.to(wired.address)).into())
    } else if mismatch.what == "channel mask" && masked {
        (Setting::Masked, mismatch.remedy.into_iter().collect())
    } else {
        return None;
    };
    Some(Leftover {
        module,
        what,
        remedies,
    })
}

/// Sends every request once and returns the leftovers found.
async fn ask(wiring: &Wiring, pace: &Pace, traffic: &mut Traffic) -> Result<Vec<Leftover>, Alarm> {
    let mut all: Vec<Leftover> = Vec::new();
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
                let Some(left) = leftover(wiring, check.module, &mismatch) else {
                    return Err(Alarm::bus(&mismatch.to_string()));
                };
                let known = |it: &Leftover| it.module == left.module && it.what == left.what;
                if !all.iter().any(known) {
                    all.push(left);
                }
            }
        }
    }
    let open: usize = pending.values().map(Vec::len).sum();
    assert_eq!(open, 0, "a request without its answer");
    Ok(all)
}
