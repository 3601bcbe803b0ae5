//! Resolves the settings of `config/rig.toml` to a checked [`Wiring`].
//!
//! The resolution checks whatever involves more than one key. Every point is one of the machine, one that a kind of
//! device declares, the beam of a bin, or the contact of a socket. It names an existing module, a channel of it, and
//! terminals of the right kind. No two points share a terminal, and no two modules an address on one line. A module has
//! exactly the settings of its model. The axis has one point for each place. The ranges of the supply have codes of
//! their own. An instrument has a profile and a link of its own. The emergency stop acts in time.

use super::axis::AxisTable;
use super::declared::{Declared, InputNames};
use super::fault::Fault;
use super::handling::{FeederTable, Handling};
use super::instruments::{Profiles, resolve_instruments};
use super::interlock::resolve_interlocks;
use super::model::Terminals;
use super::modules::resolve_modules;
use super::point::{DigitalIn, DigitalOut, Fixture, Quantity, Switch, Thermometer};
use super::rack::{self, Rack};
use super::reaction::check_reaction;
use super::settings::{
    AnalogInSettings, AnalogOutSettings, ChannelSettings, DigitalInSettings, RigSettings,
};
use super::stroke::resolve_strokes;
use super::supply::resolve_ranges;
use super::wiring::{AnalogTerminal, Line, Module, ModuleId, Terminal, Wiring};
use dcon::Channel;
use std::collections::BTreeMap;

impl Wiring {
    /// Resolves all names of a rig without instruments and checks the whole wiring; fails with the first fault.
    /// `fixtures`: points that the kinds of device declare; the rig may lack any of them.
    pub fn resolve(settings: &RigSettings, fixtures: &[Fixture]) -> Result<Self, Fault> {
        Self::resolve_with(settings, fixtures, &Profiles::new())
    }

    /// Resolves as [`Wiring::resolve`] does a rig whose instruments have these profiles.
    pub fn resolve_with(
        settings: &RigSettings,
        fixtures: &[Fixture],
        profiles: &Profiles,
    ) -> Result<Self, Fault> {
        let lines: Vec<Line> = settings
            .line
            .iter()
            .map(|(name, line)| Line {
                name: name.clone(),
                port: line.port.clone(),
                baud: line.baud,
                checksum: line.checksum,
            })
            .collect();
        check_ports(&lines)?;
        let modules = resolve_modules(settings, &lines)?;
        let instruments = resolve_instruments(&settings.instrument, &settings.line, profiles)?;
        let inputs = InputNames::of(settings, fixtures);
        let declared = Declared { settings, fixtures };
        let handling = resolve_handling(settings, &inputs, &declared)?;
        inputs.check(settings)?;
        let supply_ranges = resolve_ranges(settings, &modules)?;
        let quantities = declared.quantities();
        check_units(&settings.analog_in, &quantities)?;
        let mut terminals = TerminalsInUse {
            modules: &modules,
            taken: BTreeMap::new(),
        };
        let mut wiring = Self {
            digital_in: terminals.inputs(settings, &inputs)?,
            digital_out: terminals.outputs(settings, &declared.outputs())?,
            analog_in: terminals.wire(
                ("analog_in", Terminals::AnalogIn),
                &quantities,
                |quantity| quantity.name,
                &settings.analog_in,
            )?,
            analog_out: terminals.wire(
                ("analog_out", Terminals::AnalogOut),
                &declared.sources(),
                |name| name,
                &settings.analog_out,
            )?,
            temperature: terminals.wire(
                ("temperature", Terminals::Temperature),
                &declared.thermometers(),
                |name| name,
                &settings.temperature,
            )?,
            counter: terminals.wire(
                ("counter", Terminals::Counter),
                &declared.counters(),
                |name| name,
                &settings.counter,
            )?,
            before_beams: inputs.before_beams,
            supply_ranges,
            supply_range: None,
            lines,
            modules,
            instruments,
            bus: settings.bus,
            safety: settings.safety,
            interlocks: Vec::new(),
            handling,
        };
        wiring.interlocks =
            resolve_interlocks(&settings.actuator, |name| wiring.digital_input(name))?;
        assert!(
            DigitalIn::ALL
                .iter()
                .all(|it| wiring.input_name(*it) == it.name())
                && DigitalOut::ALL
                    .iter()
                    .all(|it| wiring.switch((*it).into()).name == it.name()),
            "points of the machine come first in their tables"
        );
        check_beams(&wiring, settings)?;
        check_masks(&wiring)?;
        check_reaction(&wiring)?;
        Ok(wiring)
    }
}

/// Terminals in use, each with the key of its point.
struct TerminalsInUse<'a> {
    modules: &'a [Module],
    taken: BTreeMap<(usize, Terminals, u8), String>,
}

impl TerminalsInUse<'_> {
    /// Reserves the terminal of `key`; fails with the reason why the terminal cannot be used.
    fn take(
        &mut self,
        key: &str,
        module: &str,
        channel: u8,
        kind: Terminals,
    ) -> Result<(ModuleId, Channel), Fault> {
        let Some(index) = self.modules.iter().position(|known| known.name == module) else {
            let known: Vec<&str> = self.modules.iter().map(|it| it.name.as_str()).collect();
            let expected = format!("one of the modules {}", known.join(", "));
            return Err(Fault::new(
                format!("{key}.module"),
                format!("\"{module}\""),
                expected,
            ));
        };
        let model = self.modules[index].model;
        let channels = model.channels(kind);
        if channels == 0 {
            let found = format!("\"{module}\", an {}", model.name());
            return Err(Fault::new(
                format!("{key}.module"),
                found,
                format!("a module with {}", kind.words()),
            ));
        }
        let Some(terminal) = Channel::new(channel).filter(|_| channel < channels) else {
            let expected = format!("0..{} of an {}", channels - 1, model.name());
            return Err(Fault::new(format!("{key}.channel"), channel, expected));
        };
        if let Some(other) = self.taken.insert((index, kind, channel), key.to_owned()) {
            let found = format!("{module} channel {channel}");
            return Err(Fault::new(key, found, "a terminal of its own").against(other));
        }
        Ok((ModuleId(index), terminal))
    }

    /// Reserves a terminal for each digital input; inputs of the machine that only the other handling needs get none.
    fn inputs(
        &mut self,
        settings: &RigSettings,
        inputs: &InputNames,
    ) -> Result<Vec<(String, Option<Terminal>)>, Fault> {
        let needed = match settings.rack {
            None => DigitalIn::NAMES_OF_FEEDER,
            Some(_) => DigitalIn::NAMES_OF_RACK,
        };
        let section = ("digital_in", Terminals::DigitalIn);
        let (before_sockets, sockets) = inputs
            .names
            .split_at(inputs.names.len() - settings.socket.len());
        let mut all = Vec::with_capacity(inputs.names.len());
        for name in before_sockets {
            let elsewhere =
                DigitalIn::NAMES.contains(&name.as_str()) && !needed.contains(&name.as_str());
            let one = std::slice::from_ref(name);
            let at = match elsewhere {
                true => None,
                false => self
                    .wire(section, one, String::as_str, &settings.digital_in)?
                    .pop(),
            };
            let terminal = at.map(|(_, at)| at.digital(settings.digital_in[name].active == "low"));
            all.push((name.clone(), terminal));
        }
        for (name, (socket, wired)) in sockets.iter().zip(&settings.socket) {
            let key = format!("socket.{socket}");
            let (module, channel) = self.take(&key, &wired.module, wired.channel, section.1)?;
            let active_low = wired.active == "low";
            all.push((
                name.clone(),
                Some(Terminal {
                    module,
                    channel,
                    active_low,
                }),
            ));
        }
        Ok(all)
    }

    /// Reserves a terminal for each digital output; outputs of the machine that only the other handling needs get none.
    fn outputs(
        &mut self,
        settings: &RigSettings,
        outputs: &[Switch],
    ) -> Result<Vec<(Switch, Option<Terminal>)>, Fault> {
        let needed = match settings.rack {
            None => DigitalOut::NAMES_OF_FEEDER,
            Some(_) => DigitalOut::NAMES_OF_RACK,
        };
        let section = ("digital_out", Terminals::DigitalOut);
        let mut all = Vec::with_capacity(outputs.len());
        for output in outputs {
            let elsewhere =
                DigitalOut::NAMES.contains(&output.name) && !needed.contains(&output.name);
            let one = std::slice::from_ref(output);
            let at = match elsewhere {
                true => None,
                false => self
                    .wire(section, one, |it| it.name, &settings.digital_out)?
                    .pop(),
            };
            all.push((*output, at.map(|(_, at)| at.digital(false))));
        }
        Ok(all)
    }

    /// Reserves a terminal for each point of a section.
    fn wire<P: Clone, W: Wired>(
        &mut self,
        (section, kind): (&str, Terminals),
        points: &[P],
        name: impl Fn(&P) -> &str,
        wired: &BTreeMap<String, W>,
    ) -> Result<Vec<(P, AnalogTerminal)>, Fault> {
        let terminal = |point: &P| {
            let key = format!("{section}.{}", name(point));
            let wired = wired.get(name(point)).ok_or_else(|| unwired(&key))?;
            let (module, channel) = wired.at();
            let (module, channel) = self.take(&key, module, channel, kind)?;
            let gain = wired.gain();
            let terminal = AnalogTerminal {
                module,
                channel,
                gain,
            };
            Ok((point.clone(), terminal))
        };
        points.iter().map(terminal).collect()
    }
}

/// Settings of a point on a terminal.
trait Wired {
    /// Returns the name of the module, and the channel.
    fn at(&self) -> (&str, u8);
    fn gain(&self) -> f64 {
        1.0
    }
}

impl Wired for DigitalInSettings {
    fn at(&self) -> (&str, u8) {
        (&self.module, self.channel)
    }
}

impl Wired for ChannelSettings {
    fn at(&self) -> (&str, u8) {
        (&self.module, self.channel)
    }
}

impl Wired for AnalogInSettings {
    fn at(&self) -> (&str, u8) {
        (&self.module, self.channel)
    }
    fn gain(&self) -> f64 {
        self.gain
    }
}

impl Wired for AnalogOutSettings {
    fn at(&self) -> (&str, u8) {
        (&self.module, self.channel)
    }
    fn gain(&self) -> f64 {
        self.gain
    }
}

impl AnalogTerminal {
    fn digital(self, active_low: bool) -> Terminal {
        Terminal {
            module: self.module,
            channel: self.channel,
            active_low,
        }
    }
}

/// Resolves the feeder, or the rack of a rig with `[rack]`.
fn resolve_handling(
    settings: &RigSettings,
    inputs: &InputNames,
    declared: &Declared,
) -> Result<Handling, Fault> {
    let Some(table) = &settings.rack else {
        let axis = AxisTable::resolve(&settings.axis, &settings.bin, |name| inputs.beam(name))?;
        let strokes = resolve_strokes(&settings.actuator)?;
        return Ok(Handling::Feeder(FeederTable { axis, strokes }));
    };
    let names = declared.thermometers();
    let thermometer = names.iter().position(|name| *name == rack::THERMOMETER);
    let Some(thermometer) = thermometer.map(Thermometer::at) else {
        return Err(unwired(&format!("temperature.{}", rack::THERMOMETER)));
    };
    let contact = |socket: &str| inputs.contact(socket);
    Rack::resolve(table, settings, thermometer, contact).map(Handling::Rack)
}

/// Checks that each analog input has the unit of its quantity.
fn check_units(
    wired: &BTreeMap<String, AnalogInSettings>,
    quantities: &[Quantity],
) -> Result<(), Fault> {
    for Quantity { name, unit, .. } in quantities {
        if let Some(wired) = wired.get(*name).filter(|wired| wired.unit != *unit) {
            return Err(Fault::new(
                format!("analog_in.{name}.unit"),
                format!("\"{}\"", wired.unit),
                format!("\"{unit}\", the unit of {name}"),
            ));
        }
    }
    Ok(())
}

fn unwired(key: &str) -> Fault {
    Fault::new(key, "nothing", "a module and a channel")
}

fn check_ports(lines: &[Line]) -> Result<(), Fault> {
    for (index, line) in lines.iter().enumerate() {
        if let Some(other) = lines[..index].iter().find(|other| other.port == line.port) {
            let fault = Fault::new(
                format!("line.{}.port", line.name),
                format!("\"{}\"", line.port),
                "a port of its own",
            );
            return Err(fault.against(format!("line.{}.port", other.name)));
        }
    }
    Ok(())
}

/// Checks that each beam is wired to an event counter, because a falling part is too quick for a scan.
fn check_beams(wiring: &Wiring, settings: &RigSettings) -> Result<(), Fault> {
    let Some(feeder) = wiring.feeder() else {
        return Ok(());
    };
    for bin in feeder.axis.bins() {
        let beam = feeder.axis.beam(bin);
        let model = wiring.module(wiring.digital_in(beam).module).model;
        if !model.counts_events() {
            let found = settings
                .bin
                .get(bin.name())
                .map_or("nothing", |bin| bin.beam.as_str());
            let expected = "a digital input with an event counter";
            return Err(Fault::new(
                format!("bin.{}.beam", bin.name()),
                format!("\"{found}\""),
                expected,
            ));
        }
    }
    Ok(())
}

/// Checks that a channel is enabled from the start if no act sets its mask.
fn check_masks(wiring: &Wiring) -> Result<(), Fault> {
    for (point, at) in wiring.analog_in.iter().filter(|(point, _)| point.enabled) {
        let module = wiring.module(at.module);
        if let Some(mask) = module.mask.filter(|mask| mask >> at.channel.get() & 1 == 0) {
            let (channel, name) = (at.channel, point.name);
            return Err(Fault::new(
                format!("module.{}.mask", module.name),
                format!("\"{mask:02X}\""),
                format!("a mask with channel {channel} ({name}) enabled"),
            ));
        }
    }
    Ok(())
}
