//! Is this the rig of the file? What is asked of every module at start, and what it must answer.
//!
//! Everything here reads. A difference is a [`Mismatch`] that names line, address, module, found and expected;
//! what would set it right ([`Mismatch::remedy`]) writes to the module's EEPROM and is for set-up and `calibrate`,
//! never for a lot.
//!
//! | asked | must be |
//! |---|---|
//! | `$AA2` | type code, baud, check sum; notation, fast mode and slew code where the model has them |
//! | `$AAM` | not the name of another model (a name of the owner's own says nothing) |
//! | `$AA6` of a 7017 | the channel mask |
//! | `~AA0`, modules with outputs | host watchdog not tripped |
//! | `~AA2`, modules with outputs | host watchdog as wired, with `host_watchdog_ms` |
//! | `~AA4`, modules with outputs | the safe value |
//! | `$AA5`, not the 7080 | anything: reading it clears the flag, so that a later reset shows |

use super::judge::Judge;
use super::model::Terminals;
use super::wiring::{Module, ModuleId, Wiring};
use dcon::{Address, Command, Common, Digital, Reply, Stored};
use thiserror::Error;

/// One question to one module.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Check {
    /// The module.
    pub module: ModuleId,
    /// The question.
    pub command: Command,
}

/// A module that is not as wired.
#[derive(Debug, Clone, PartialEq, Error)]
#[error(
    "line {line}, address {address}, module {module}: {what}: found {found}, expected {expected}"
)]
pub struct Mismatch {
    /// Name of the line.
    pub line: String,
    /// Address on that line.
    pub address: Address,
    /// Name of the module.
    pub module: String,
    /// What differs; `wrong module type at address` when it is another kind of module.
    pub what: &'static str,
    /// What the module said.
    pub found: String,
    /// What the wiring says.
    pub expected: String,
    /// The command that would set it right, where one can. Writes EEPROM.
    pub remedy: Option<Command>,
}

/// Every question to every module, line by line.
pub fn verification(wiring: &Wiring) -> Vec<Check> {
    let questions = |id: ModuleId| {
        let module = wiring.module(id);
        let mut commands = vec![
            Common::ReadConfig.to(module.address),
            Common::ReadName.to(module.address),
        ];
        if module.mask.is_some() {
            commands.push(dcon::AnalogIn::ReadMask.to(module.address));
        }
        if module.model.has_outputs() {
            commands.push(Common::ReadWatchdogStatus.to(module.address));
            commands.push(Common::ReadWatchdog.to(module.address));
            commands.push(read_safe(module));
        }
        if module.model.channels(Terminals::Counter) == 0 {
            commands.push(Common::ReadResetStatus.to(module.address));
        }
        commands.into_iter().map(move |command| Check {
            module: id,
            command,
        })
    };
    wiring.module_ids().flat_map(questions).collect()
}

fn read_safe(module: &Module) -> Command {
    match module.output_form() {
        Some(form) => dcon::AnalogOut::ReadSafe {
            channel: None,
            form,
        }
        .to(module.address),
        None => Digital::ReadStored(Stored::Safe).to(module.address),
    }
}

/// Compares an answer with the wiring: the difference, or `None` when the module is as wired.
pub fn judge(wiring: &Wiring, check: &Check, reply: &Reply) -> Option<Mismatch> {
    let judge = Judge {
        wiring,
        module: wiring.module(check.module),
    };
    match reply {
        Reply::Config { config, .. } => judge.config(*config),
        Reply::Text(name) => judge.name(name.as_str()),
        Reply::Byte(byte) if check.command == dcon::AnalogIn::ReadMask.to(judge.module.address) => {
            judge.mask(*byte)
        }
        Reply::Byte(status) => judge.status(*status),
        Reply::Watchdog {
            enabled,
            timeout_tenths,
        } => judge.watchdog(*enabled, *timeout_tenths),
        Reply::Level(level) => judge.safe_level(*level),
        Reply::Bits(bits) => judge.safe_bits(bits.word()),
        Reply::Flag(_)
        | Reply::Sent
        | Reply::Accepted
        | Reply::Decimal(_)
        | Reply::Sampled { .. }
        | Reply::Events(_)
        | Reply::Count(_)
        | Reply::Frequency(_)
        | Reply::Gate(_)
        | Reply::Inputs(_)
        | Reply::Alarm(_)
        | Reply::Reading(_)
        | Reply::Readings(_)
        | Reply::OutputChannel { .. }
        | Reply::ChannelRange { .. } => None,
    }
}
