//! Checks at start that the modules on the lines are those of `config/rig.toml`: the requests to every module, and the
//! answers that they require.
//!
//! All requests are reads. A difference is a [`Mismatch`] with line, address, module, found and expected value. Its
//! [`Mismatch::remedy`] is a write to the module's EEPROM; set-up and `calibrate` send it, a lot never does.
//!
//! | request | must be |
//! |---|---|
//! | `$AA2` | type code, baud, checksum; notation, fast mode and slew code where the model has them |
//! | `$AAM` | not the name of another model (a name given by the owner passes) |
//! | `$AA6` of a 7017 | the channel mask |
//! | `~AA0`, modules with outputs | host watchdog not tripped |
//! | `~AA2`, modules with outputs | host watchdog as wired, with `host_watchdog_ms` |
//! | `~AA4`, modules with outputs | the safe value |
//! | `$AA5`, not the 7080 | any answer: reading the reset status clears it, so that a later reset shows |

use super::comparison::Comparison;
use super::model::Terminals;
use super::wiring::{Module, ModuleId, Wiring};
use dcon::{Address, Command, Common, Digital, Reply, Stored};
use texts::Message;
use thiserror::Error;

/// One request to one module.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Check {
    /// The addressed module.
    pub module: ModuleId,
    /// The request.
    pub command: Command,
}

/// A module that differs from the wiring.
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
    /// The differing setting; `wrong module type at address` for another model.
    pub what: &'static str,
    /// Value from the module.
    pub found: String,
    /// Value required by the wiring.
    pub expected: String,
    /// Command that corrects the setting by a write to the module's EEPROM; `None` when no command does.
    pub remedy: Option<Command>,
}

impl Mismatch {
    /// Returns the mismatch as a message of family `detail`, for an alarm.
    pub fn message(&self) -> Message {
        Message::detail("mismatch", self)
            .with("line", &self.line)
            .with("address", self.address)
            .with("module", &self.module)
    }
}

/// Returns every request to every module, line by line.
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
            commands.extend(read_safe(module));
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

fn read_safe(module: &Module) -> Vec<Command> {
    let Some(form) = module.output_form() else {
        return vec![Digital::ReadStored(Stored::Safe).to(module.address)];
    };
    let read = |channel| dcon::AnalogOut::ReadSafe { channel, form }.to(module.address);
    module.level_channels().into_iter().map(read).collect()
}

/// Compares an answer with the wiring; returns the difference, or `None` when they agree.
pub fn judge(wiring: &Wiring, check: &Check, reply: &Reply) -> Option<Mismatch> {
    let comparison = Comparison {
        wiring,
        module: wiring.module(check.module),
    };
    match reply {
        Reply::Config { config, .. } => comparison.config(*config),
        Reply::Text(name) => comparison.name(name.as_str()),
        Reply::Byte(byte)
            if check.command == dcon::AnalogIn::ReadMask.to(comparison.module.address) =>
        {
            comparison.mask(*byte)
        }
        Reply::Byte(status) => comparison.status(*status),
        Reply::Watchdog {
            enabled,
            timeout_tenths,
        } => comparison.watchdog(*enabled, *timeout_tenths),
        Reply::Level(level) => comparison.safe_level(*level),
        Reply::Bits(bits) => comparison.safe_bits(bits.word()),
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
        | Reply::AlarmMode(_)
        | Reply::Reading(_)
        | Reply::Readings(_)
        | Reply::OutputChannel { .. }
        | Reply::ChannelRange { .. } => None,
    }
}
