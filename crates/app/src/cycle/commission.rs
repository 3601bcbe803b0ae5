//! Compares every module's name and settings with the wiring before anything moves. Outputs are still safe, so no
//! emergency stop waits, and each line repeats a question as often as the bus settings allow.

use super::traffic::{Purpose, Traffic};
use bus::Pace;
use dcon::{Command, Common};
use machine::dut;
use machine::rig::commission::{Mismatch, judge, verification};
use machine::rig::wiring::{ModuleId, Wiring};
use machine::station::trouble::Alarm;
use std::collections::BTreeMap;

/// What a life of the controller that was cut off has left in a module.
struct Left {
    module: ModuleId,
    what: What,
    /// What puts it right; it is written to the EEPROM of the module.
    remedies: Vec<Command>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum What {
    /// The host watchdog has tripped: the module stands at its safe outputs and has switched its watchdog off.
    Tripped,
    /// The converter still has the channel mask of the references.
    Masked,
}

/// Asks everything, line by line in parallel; the first disagreement or silent module is the alarm. What the
/// controller itself left behind when it was cut off is put right, and told.
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
        put_right(wiring, pace, traffic, one).await?;
    }
    let still = ask(wiring, pace, traffic).await?;
    traffic.start_scan();
    let name = |one: &Left| wiring.module(one.module).name.clone();
    if let Some(one) = still.first() {
        let what = match one.what {
            What::Tripped => "tripped",
            What::Masked => "masked",
        };
        return Err(Alarm::bus(&format!("{} stays {what}", name(one))));
    }
    let names = |what: What| {
        let those: Vec<String> = left.iter().filter(|it| it.what == what).map(name).collect();
        (!those.is_empty()).then(|| those.join(", "))
    };
    let tripped = names(What::Tripped).map(|names| Alarm::watchdog_tripped(&names));
    let masked = names(What::Masked).map(|names| Alarm::calibration_cut_off(&names));
    Ok(tripped.into_iter().chain(masked).collect())
}

async fn put_right(
    wiring: &Wiring,
    pace: &Pace,
    traffic: &mut Traffic,
    left: &Left,
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

/// A disagreement that the controller itself has left behind.
fn left_behind(wiring: &Wiring, module: ModuleId, mismatch: &Mismatch) -> Option<Left> {
    let wired = wiring.module(module);
    let of_references = wiring.mask_of(module, &dut::reference_inputs(wiring));
    let masked = of_references != 0 && mismatch.found == format!("{of_references:02X}");
    let (what, remedies) = if mismatch.what == "host watchdog" {
        let enable = Common::WriteWatchdog {
            enabled: wired.watchdog,
            timeout_tenths: (wiring.bus.host_watchdog_ms / 100.0).round() as u8,
        };
        let both = [Common::ClearWatchdogStatus, enable];
        (What::Tripped, both.map(|it| it.to(wired.address)).into())
    } else if mismatch.what == "channel mask" && masked {
        (What::Masked, mismatch.remedy.into_iter().collect())
    } else {
        return None;
    };
    Some(Left {
        module,
        what,
        remedies,
    })
}

/// Every question once; what was left behind.
async fn ask(wiring: &Wiring, pace: &Pace, traffic: &mut Traffic) -> Result<Vec<Left>, Alarm> {
    let mut all: Vec<Left> = Vec::new();
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
                let Some(left) = left_behind(wiring, check.module, &mismatch) else {
                    return Err(Alarm::bus(&mismatch.to_string()));
                };
                let known = |it: &Left| it.module == left.module && it.what == left.what;
                if !all.iter().any(known) {
                    all.push(left);
                }
            }
        }
    }
    let open: usize = pending.values().map(Vec::len).sum();
    assert_eq!(open, 0, "a question without its answer");
    Ok(all)
}
