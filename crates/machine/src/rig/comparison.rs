//! Compares one answer of one module with the wiring.
//!
//! Some bits of the format byte have no setting (mains filter, model codes of digital modules); the comparison accepts
//! any value in them.

use super::commission::Mismatch;
use super::model::Model;
use super::wiring::{Module, Wiring};
use dcon::{BaudCode, Command, Common, Config, DataFormat, FormatByte, Level};

/// The wiring of one module, for comparison with its answers.
pub(super) struct Comparison<'a> {
    pub(super) wiring: &'a Wiring,
    pub(super) module: &'a Module,
}

impl Comparison<'_> {
    fn mismatch(
        &self,
        what: &'static str,
        found: impl ToString,
        expected: impl ToString,
    ) -> Mismatch {
        Mismatch {
            line: self.wiring.line(self.module.line).name.clone(),
            address: self.module.address,
            module: self.module.name.clone(),
            what,
            found: found.to_string(),
            expected: expected.to_string(),
            remedy: None,
        }
    }

    /// Returns the mismatch with the command that corrects it.
    fn corrected_by(
        &self,
        remedy: Command,
        what: &'static str,
        found: impl ToString,
        expected: impl ToString,
    ) -> Mismatch {
        Mismatch {
            remedy: Some(remedy),
            ..self.mismatch(what, found, expected)
        }
    }

    pub(super) fn config(&self, found: Config) -> Option<Mismatch> {
        let module = self.module;
        if found.type_code != module.type_code {
            let foreign = !module.model.accepts_type(found.type_code.0);
            let what = if foreign {
                "wrong module type at address"
            } else {
                "type code"
            };
            let expected = format!(
                "type {:02X} of an {}",
                module.type_code.0,
                module.model.name()
            );
            return Some(self.mismatch(what, format!("type {:02X}", found.type_code.0), expected));
        }
        let line = self.wiring.line(module.line);
        if found.baud.rate() != Some(line.baud) {
            return Some(self.mismatch("baud code", format!("{:02X}", found.baud.0), line.baud));
        }
        let wanted = self.wanted_format(found.format);
        if found.format == wanted {
            return None;
        }
        let config = Config {
            type_code: module.type_code,
            baud: BaudCode(found.baud.0),
            format: wanted,
        };
        let remedy = Common::WriteConfig {
            address: module.address,
            config,
        }
        .to(module.address);
        let [found, expected] = [found.format, wanted].map(|it| format!("{:02X}", it.0));
        Some(self.corrected_by(remedy, "format byte", found, expected))
    }

    /// Returns the required format byte, with the value found in the bits that have no setting.
    fn wanted_format(&self, found: FormatByte) -> FormatByte {
        const CHECKSUM: u8 = 0x40;
        const FAST: u8 = 0x20;
        const SLEW: u8 = 0x3C;
        const NOTATION: u8 = 0x03;
        let mut byte = found.0 & !CHECKSUM;
        if self.wiring.line(self.module.line).checksum {
            byte |= CHECKSUM;
        }
        if let Some(format) = self.module.format {
            byte = byte & !NOTATION | notation(format);
        }
        if matches!(self.module.model, Model::I7017F | Model::I7017R) {
            byte = byte & !FAST | if self.module.fast { FAST } else { 0 };
        }
        if let Some(slew) = self.module.slew {
            byte = byte & !SLEW | slew.0.get() << 2;
        }
        FormatByte(byte)
    }

    pub(super) fn name(&self, name: &str) -> Option<Mismatch> {
        let bare = |model: Model| model.name().trim_start_matches("I-");
        let own = name.starts_with(bare(self.module.model));
        if own
            || !Model::ALL
                .iter()
                .any(|model| name.starts_with(bare(*model)))
        {
            return None;
        }
        Some(self.mismatch(
            "wrong module type at address",
            name,
            self.module.model.name(),
        ))
    }

    pub(super) fn mask(&self, found: u8) -> Option<Mismatch> {
        let mask = self.module.mask.filter(|mask| *mask != found)?;
        let remedy = dcon::AnalogIn::WriteMask(mask).to(self.module.address);
        let [found, expected] = [found, mask].map(|it| format!("{it:02X}"));
        Some(self.corrected_by(remedy, "channel mask", found, expected))
    }

    pub(super) fn status(&self, status: u8) -> Option<Mismatch> {
        /// Bit 2: the host watchdog has timed out.
        const TRIPPED: u8 = 0x04;
        if status & TRIPPED == 0 {
            return None;
        }
        let remedy = Common::ClearWatchdogStatus.to(self.module.address);
        Some(self.corrected_by(remedy, "host watchdog", "tripped", "not tripped"))
    }

    pub(super) fn watchdog(&self, enabled: Option<bool>, timeout_tenths: u8) -> Option<Mismatch> {
        let wanted_tenths = (self.wiring.bus.host_watchdog_ms / 100.0).round() as u8;
        let wanted = self.module.watchdog;
        let same_switch = enabled.is_none_or(|on| on == wanted);
        if same_switch && (!wanted || timeout_tenths == wanted_tenths) {
            return None;
        }
        let words = |on: Option<bool>, tenths: u8| {
            let on = match on {
                Some(true) => "on",
                Some(false) => "off",
                None => "set",
            };
            format!("{on}, {:.1} s", f64::from(tenths) / 10.0)
        };
        let command = Common::WriteWatchdog {
            enabled: wanted,
            timeout_tenths: wanted_tenths,
        };
        Some(self.corrected_by(
            command.to(self.module.address),
            "host watchdog",
            words(enabled, timeout_tenths),
            words(Some(wanted), wanted_tenths),
        ))
    }

    /// Compares the safe value of an analog output; returns the mismatch, if there is one. The mismatch has no remedy:
    /// no single command corrects it, because the module stores its present output as the safe value.
    pub(super) fn safe_level(&self, found: Level) -> Option<Mismatch> {
        let safe = self.module.safe_volts;
        let volts = found.in_units(self.module.type_code).unwrap_or(f64::NAN);
        // The comparison accepts a difference of two steps of a 12-bit output.
        if (volts - safe).abs() <= 0.005 {
            return None;
        }
        Some(self.mismatch(
            "safe value",
            format!("{volts:.3} V"),
            format!("{safe:.3} V"),
        ))
    }

    pub(super) fn safe_bits(&self, found: u16) -> Option<Mismatch> {
        let wanted = self.module.safe_outputs;
        if found == wanted {
            return None;
        }
        Some(self.mismatch(
            "safe value",
            format!("{found:04X}"),
            format!("{wanted:04X}"),
        ))
    }
}

fn notation(format: DataFormat) -> u8 {
    match format {
        DataFormat::Engineering => 0,
        DataFormat::Percent => 1,
        DataFormat::Hex => 2,
    }
}
