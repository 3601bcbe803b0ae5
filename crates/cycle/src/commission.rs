//! Compares the name and the settings of every module with the wiring, before anything moves. The outputs are still
//! safe, so nothing polls the emergency stop yet, and a line may repeat a request as often as the bus settings allow.

use super::answers::AnswerTrouble;
use super::lateness::Lateness;
use super::traffic::{Purpose, Traffic};
use bus::{Answer, Pace, Timer};
use dcon::{AnalogIn, Command, Common, Reply};
use machine::dut;
use machine::rig::commission::{Check, judge, verification};
use machine::rig::wiring::{ModuleId, Wiring};
use machine::station::trouble::Alarm;
use std::collections::{BTreeMap, VecDeque};
use texts::Message;
use units::Span;

/// Longest wait before the verification checks the clock again, so that it measures a stall of this computer.
const LOOK: Span = Span::ms(5);

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
    /// The analog input module still converts only the channels that a calibration reads.
    Masked,
}

/// The verification of all modules, with the parts of the cycle that it uses.
pub struct Verification<'a> {
    pub wiring: &'a Wiring,
    pub pace: &'a Pace,
    pub traffic: &'a mut Traffic,
    pub timer: &'a mut Timer,
    pub lateness: &'a mut Lateness,
}

impl Verification<'_> {
    /// Reads all settings, on all lines in parallel; fails with an alarm at the first mismatch or silent module.
    /// Restores the settings that an interrupted run of the controller left behind; returns alarms that name their
    /// modules.
    pub async fn run(&mut self) -> Result<Vec<Alarm>, Alarm> {
        let left = self.ask().await?;
        if left.is_empty() {
            self.traffic.start_scan();
            return Ok(Vec::new());
        }
        for one in &left {
            self.restore(one).await?;
        }
        let still = self.ask().await?;
        self.traffic.start_scan();
        let name = |one: &Leftover| self.wiring.module(one.module).name.clone();
        if let Some(one) = still.first() {
            let detail = Message::new("detail", "not_restored").with("module", name(one));
            return Err(Alarm::bus(&detail));
        }
        let names = |what: Setting| {
            let those: Vec<String> = left.iter().filter(|it| it.what == what).map(name).collect();
            (!those.is_empty()).then(|| those.join(", "))
        };
        let tripped = names(Setting::Tripped).map(|names| Alarm::watchdog_tripped(&names));
        let masked = names(Setting::Masked).map(|names| Alarm::calibration_cut_off(&names));
        Ok(tripped.into_iter().chain(masked).collect())
    }

    async fn restore(&mut self, left: &Leftover) -> Result<(), Alarm> {
        for command in &left.remedies {
            let line = self.wiring.module(left.module).line;
            self.traffic.queue(line, *command, Purpose::Check);
            loop {
                self.traffic.dispatch(self.pace.now());
                self.wait().await;
                if let Some((_, Purpose::Check, answer)) = self.traffic.next_answer() {
                    self.replied(answer)?;
                    break;
                }
            }
        }
        Ok(())
    }

    /// Waits for an answer, and counts how late this computer wakes.
    async fn wait(&mut self) {
        let mut answered = false;
        while !answered {
            let until = self.pace.now() + LOOK;
            tokio::select! {
                biased;
                () = self.traffic.answer() => answered = true,
                () = self.timer.until(until) => {}
            }
            self.lateness.count(until, self.pace.now());
        }
    }

    /// Returns the reply of an answer; fails with an alarm when there is none.
    fn replied(&self, answer: Answer) -> Result<Reply, Alarm> {
        let (used, tries) = (answer.tries_used, self.wiring.bus.tries);
        let late = self.lateness.explaining(self.wiring);
        let alarm = |error| AnswerTrouble::of(&error, used, tries, late).alarm();
        answer.outcome.map_err(alarm)
    }

    /// Requests every name and setting once; returns the leftovers, or an alarm about any other mismatch.
    async fn ask(&mut self) -> Result<Vec<Leftover>, Alarm> {
        let mut all: Vec<Leftover> = Vec::new();
        let wiring = self.wiring;
        let checks = verification(wiring);
        let mut pending: BTreeMap<usize, VecDeque<&Check>> = BTreeMap::new();
        for check in &checks {
            let line = wiring.module(check.module).line;
            self.traffic.queue(line, check.command, Purpose::Check);
            pending.entry(line.0).or_default().push_back(check);
        }
        while pending.values().any(|checks| !checks.is_empty()) {
            self.traffic.dispatch(self.pace.now());
            self.wait().await;
            while let Some((line, purpose, answer)) = self.traffic.next_answer() {
                if purpose != Purpose::Check {
                    continue;
                }
                let Some(check) = pending.get_mut(&line.0).and_then(VecDeque::pop_front) else {
                    continue;
                };
                let is_status =
                    matches!(answer.command, Command::Common(_, Common::ReadResetStatus));
                if is_status && answer.outcome.is_err() {
                    continue;
                }
                let reply = self.replied(answer)?;
                if let Some(mismatch) = judge(wiring, check, &reply) {
                    let Some(left) = leftover(wiring, check, &reply, mismatch.remedy) else {
                        return Err(Alarm::bus(&mismatch.message()));
                    };
                    let known = |it: &Leftover| it.module == left.module && it.what == left.what;
                    if !all.iter().any(known) {
                        all.push(left);
                    }
                }
            }
        }
        Ok(all)
    }
}

/// Returns the leftover that explains a wrong reply; `None` when the controller did not cause the wrong setting.
/// `remedy` is the command that corrects it.
fn leftover(
    wiring: &Wiring,
    check: &Check,
    reply: &Reply,
    remedy: Option<Command>,
) -> Option<Leftover> {
    let module = check.module;
    let wired = wiring.module(module);
    let of_references = wiring.mask_of(module, &dut::reference_inputs(wiring));
    let masked = of_references != 0 && *reply == Reply::Byte(of_references);
    let (what, remedies) = if matches!(
        check.command,
        Command::Common(_, Common::ReadWatchdogStatus | Common::ReadWatchdog)
    ) {
        let enable = Common::WriteWatchdog {
            enabled: wired.watchdog,
            timeout_tenths: (wiring.bus.host_watchdog_ms / 100.0).round() as u8,
        };
        let both = [Common::ClearWatchdogStatus, enable];
        (Setting::Tripped, both.map(|it| it.to(wired.address)).into())
    } else if masked && matches!(check.command, Command::AnalogIn(_, AnalogIn::ReadMask)) {
        (Setting::Masked, remedy.into_iter().collect())
    } else {
        return None;
    };
    Some(Leftover {
        module,
        what,
        remedies,
    })
}
