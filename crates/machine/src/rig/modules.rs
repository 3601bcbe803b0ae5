//! Resolves the modules of the settings: names, addresses, and for each module exactly the settings that its model has.

use super::fault::Fault;
use super::model::{Model, Terminals};
use super::settings::{ModuleSettings, RigSettings};
use super::wiring::{Line, LineId, Module};
use dcon::{Address, DataFormat, SlewCode, TypeCode, UpTo};

/// Returns every module, sorted by line and address.
pub(super) fn resolve_modules(
    settings: &RigSettings,
    lines: &[Line],
) -> Result<Vec<Module>, Fault> {
    let mut modules: Vec<Module> = Vec::with_capacity(settings.module.len());
    for (name, module) in &settings.module {
        let resolved = resolve_module(name, module, lines)?;
        let clash =
            |other: &&Module| other.line == resolved.line && other.address == resolved.address;
        if let Some(other) = modules.iter().find(clash) {
            let found = quoted(&module.address);
            let expected = format!("an address of its own on line {}", module.line);
            let fault = Fault::new(format!("module.{name}.address"), found, expected);
            return Err(fault.against(format!("module.{}.address", other.name)));
        }
        modules.push(resolved);
    }
    modules.sort_by_key(|module| (module.line, module.address.0));
    Ok(modules)
}

fn resolve_module(name: &str, settings: &ModuleSettings, lines: &[Line]) -> Result<Module, Fault> {
    let form = ModuleForm {
        key: format!("module.{name}"),
        model: model(name, settings)?,
        settings,
    };
    let line = lines
        .iter()
        .position(|line| line.name == settings.line)
        .ok_or_else(|| {
            let known: Vec<&str> = lines.iter().map(|line| line.name.as_str()).collect();
            form.fault(
                "line",
                &settings.line,
                format!("one of the lines {}", known.join(", ")),
            )
        })?;
    Ok(Module {
        name: name.to_owned(),
        line: LineId(line),
        address: Address(form.hex("address", &settings.address, 2)? as u8),
        model: form.model,
        type_code: form.type_code()?,
        format: form.format()?,
        fast: form.fast()?,
        mask: form.mask()?,
        slew: form.slew()?,
        watchdog: form.watchdog()?,
        safe_volts: form.safe_volts()?,
        safe_outputs: form.safe_outputs()?,
    })
}

fn model(name: &str, settings: &ModuleSettings) -> Result<Model, Fault> {
    Model::from_name(&settings.model).ok_or_else(|| {
        let expected = format!("one of {}", Model::NAMES.join(", "));
        Fault::new(
            format!("module.{name}.model"),
            quoted(&settings.model),
            expected,
        )
    })
}

struct ModuleForm<'a> {
    key: String,
    model: Model,
    settings: &'a ModuleSettings,
}

impl ModuleForm<'_> {
    fn fault(&self, key: &str, found: &str, expected: impl Into<String>) -> Fault {
        Fault::new(format!("{}.{key}", self.key), quoted(found), expected)
    }

    /// Returns the fault of a key that this model does not use.
    fn needless(&self, key: &str, found: impl ToString) -> Fault {
        let expected = format!("no such key: an {} has no {key}", self.model.name());
        Fault::new(format!("{}.{key}", self.key), found, expected)
    }

    fn missing(&self, key: &str, expected: &str) -> Fault {
        Fault::new(
            self.key.clone(),
            format!("no {key}"),
            format!("{key} of an {}: {expected}", self.model.name()),
        )
    }

    fn hex(&self, key: &str, text: &str, digits: usize) -> Result<u16, Fault> {
        let upper = text.bytes().all(|c| matches!(c, b'0'..=b'9' | b'A'..=b'F'));
        match u16::from_str_radix(text, 16) {
            Ok(value) if upper && text.len() == digits => Ok(value),
            Ok(_) | Err(_) => Err(self.fault(key, text, format!("{digits} hexadecimal digits"))),
        }
    }

    fn type_code(&self) -> Result<TypeCode, Fault> {
        let code = self.hex("type", &self.settings.type_code, 2)? as u8;
        if self.model.accepts_type(code) {
            return Ok(TypeCode(code));
        }
        let codes: Vec<String> = self
            .model
            .type_codes()
            .iter()
            .map(|code| format!("{code:02X}"))
            .collect();
        let expected = format!("{} for an {}", codes.join(", "), self.model.name());
        Err(self.fault("type", &self.settings.type_code, expected))
    }

    fn format(&self) -> Result<Option<DataFormat>, Fault> {
        match (&self.settings.format, self.model.is_analog()) {
            (None, false) => Ok(None),
            (Some(text), false) => Err(self.needless("format", quoted(text))),
            (None, true) => Err(self.missing("format", "hex, engineering or percent")),
            (Some(text), true) => match text.as_str() {
                "hex" => Ok(Some(DataFormat::Hex)),
                "engineering" => Ok(Some(DataFormat::Engineering)),
                "percent" => Ok(Some(DataFormat::Percent)),
                _ => Err(self.fault("format", text, "hex, engineering or percent")),
            },
        }
    }

    fn fast(&self) -> Result<bool, Fault> {
        let can = matches!(self.model, Model::I7017F | Model::I7017R);
        match self.settings.fast {
            Some(fast) if !can => Err(self.needless("fast", fast)),
            Some(fast) => Ok(fast),
            None => Ok(false),
        }
    }

    fn mask(&self) -> Result<Option<u8>, Fault> {
        let can = self.model.channels(Terminals::AnalogIn) > 0;
        match &self.settings.mask {
            Some(text) if !can => Err(self.needless("mask", quoted(text))),
            Some(text) if text == "00" => {
                Err(self.fault("mask", text, "at least one enabled channel"))
            }
            Some(text) => Ok(Some(self.hex("mask", text, 2)? as u8)),
            None if can => Err(self.missing("mask", "the enabled channels")),
            None => Ok(None),
        }
    }

    fn slew(&self) -> Result<Option<SlewCode>, Fault> {
        let can = self.model.channels(Terminals::AnalogOut) > 0;
        match &self.settings.slew {
            Some(text) if !can => Err(self.needless("slew", quoted(text))),
            Some(text) => {
                let code = UpTo::new(self.hex("slew", text, 1)? as u8);
                code.map(|code| Some(SlewCode(code)))
                    .ok_or_else(|| self.fault("slew", text, "0 to F"))
            }
            None if can => Err(self.missing("slew", "the slew code")),
            None => Ok(None),
        }
    }

    fn watchdog(&self) -> Result<bool, Fault> {
        match (self.settings.watchdog, self.model.has_outputs()) {
            (Some(on), true) => Ok(on),
            (None, true) => Err(self.missing("watchdog", "true or false")),
            (Some(on), false) => Err(self.needless("watchdog", on)),
            (None, false) => Ok(false),
        }
    }

    fn safe_volts(&self) -> Result<f64, Fault> {
        let can = self.model.channels(Terminals::AnalogOut) > 0;
        match self.settings.safe {
            Some(volts) if can => Ok(volts),
            None if can => Err(self.missing("safe", "its safe value in V")),
            Some(volts) => Err(self.needless("safe", volts)),
            None => Ok(0.0),
        }
    }

    fn safe_outputs(&self) -> Result<u16, Fault> {
        let can = self.model.channels(Terminals::DigitalOut) > 0;
        match &self.settings.safe_outputs {
            Some(text) if can => self.hex("safe_outputs", text, 4),
            None if can => Err(self.missing("safe_outputs", "4 hexadecimal digits")),
            Some(text) => Err(self.needless("safe_outputs", quoted(text))),
            None => Ok(0),
        }
    }
}

fn quoted(text: &str) -> String {
    format!("\"{text}\"")
}
