//! From the settings of `config/rig.toml` to a checked [`Wiring`].
//!
//! Checked here, because it takes more than one key to see it: that every point is one of the machine, one that a
//! kind of device declares or the beam of a bin; that it names a module that exists, on a channel it has, of the kind the point needs; that no two points share a terminal and no
//! two modules an address on one line; that a module has the settings its model needs and no others;
//! that the axis has one point for each place; that the emergency stop acts in time.

use super::axis::AxisTable;
use super::declared::{Declared, InputNames};
use super::fault::Fault;
use super::model::Terminals;
use super::modules::resolve_modules;
use super::point::{DigitalIn, DigitalOut, Fixture, Quantity, Switch};
use super::reaction::check_reaction;
use super::settings::{ActuatorSettings, ChannelSettings, RigSettings};
use super::wiring::{AnalogTerminal, Line, Module, ModuleId, StrokeLimits, Terminal, Wiring};
use dcon::Channel;
use std::collections::BTreeMap;
use units::Span;

impl Wiring {
    /// Resolves all names and checks the whole; the first fault found is returned. `fixtures`: what the kinds of
    /// device declare; the rig may lack any of it.
    pub fn resolve(settings: &RigSettings, fixtures: &[Fixture]) -> Result<Self, Fault> {
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
        let inputs = InputNames::of(settings, fixtures);
        let axis = AxisTable::resolve(&settings.axis, &settings.bin, |name| inputs.beam(name))?;
        inputs.check(settings)?;
        let strokes = resolve_strokes(&settings.actuator)?;
        let declared = Declared { settings, fixtures };
        let mut terminals = TerminalBook {
            modules: &modules,
            taken: BTreeMap::new(),
        };
        let wiring = Self {
            digital_in: terminals.digital_in(settings, &inputs.names)?,
            digital_out: terminals.digital_out(settings, &declared.outputs())?,
            analog_in: terminals.analog_in(settings, &declared.quantities())?,
            analog_out: terminals.analog_out(settings, &declared.sources())?,
            temperature: terminals.channels(
                "temperature",
                &declared.thermometers(),
                &settings.temperature,
                Terminals::Temperature,
            )?,
            counter: terminals.channels(
                "counter",
                &declared.counters(),
                &settings.counter,
                Terminals::Counter,
            )?,
            before_beams: inputs.before_beams,
            lines,
            modules,
            bus: settings.bus,
            safety: settings.safety,
            strokes,
            axis,
        };
        assert!(
            DigitalIn::ALL
                .iter()
                .all(|it| wiring.input_name(*it) == it.name())
                && DigitalOut::ALL
                    .iter()
                    .all(|it| wiring.switch((*it).into()).name == it.name()),
            "points of the machine stand first in their tables"
        );
        check_beams(&wiring, settings)?;
        check_masks(&wiring)?;
        check_reaction(&wiring)?;
        Ok(wiring)
    }
}

/// A terminal that exists.
struct Place {
    module: ModuleId,
    channel: Channel,
}

/// The terminals given away so far, with the key of the point that has them.
struct TerminalBook<'a> {
    modules: &'a [Module],
    taken: BTreeMap<(usize, Terminals, u8), String>,
}

impl TerminalBook<'_> {
    /// Gives `key` its terminal, or says why it cannot have it.
    fn take(
        &mut self,
        key: &str,
        module: &str,
        channel: u8,
        kind: Terminals,
    ) -> Result<Place, Fault> {
        let Some(index) = self.modules.iter().position(|known| known.name == module) else {
            let known: Vec<&str> = self
                .modules
                .iter()
                .map(|module| module.name.as_str())
                .collect();
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
        let Some(place) = Channel::new(channel).filter(|_| channel < channels) else {
            let expected = format!("0..{} of an {}", channels - 1, model.name());
            return Err(Fault::new(format!("{key}.channel"), channel, expected));
        };
        if let Some(other) = self.taken.insert((index, kind, channel), key.to_owned()) {
            let found = format!("{module} channel {channel}");
            return Err(Fault::new(key, found, "a terminal of its own").against(other));
        }
        Ok(Place {
            module: ModuleId(index),
            channel: place,
        })
    }

    fn digital_in(
        &mut self,
        settings: &RigSettings,
        names: &[String],
    ) -> Result<Vec<(String, Terminal)>, Fault> {
        let mut terminals = Vec::with_capacity(names.len());
        for name in names {
            let key = format!("digital_in.{name}");
            let point = settings.digital_in.get(name).ok_or_else(|| unwired(&key))?;
            let Place { module, channel } =
                self.take(&key, &point.module, point.channel, Terminals::DigitalIn)?;
            let terminal = Terminal {
                module,
                channel,
                active_low: point.active == "low",
            };
            terminals.push((name.clone(), terminal));
        }
        Ok(terminals)
    }

    fn digital_out(
        &mut self,
        settings: &RigSettings,
        outputs: &[Switch],
    ) -> Result<Vec<(Switch, Terminal)>, Fault> {
        let names: Vec<&'static str> = outputs.iter().map(|it| it.name).collect();
        let wired = &settings.digital_out;
        let terminals = self.channels("digital_out", &names, wired, Terminals::DigitalOut)?;
        let plain = |at: AnalogTerminal| Terminal {
            module: at.module,
            channel: at.channel,
            active_low: false,
        };
        let both = outputs.iter().zip(terminals);
        Ok(both.map(|(it, (_, at))| (*it, plain(at))).collect())
    }

    fn analog_in(
        &mut self,
        settings: &RigSettings,
        quantities: &[Quantity],
    ) -> Result<Vec<(Quantity, AnalogTerminal)>, Fault> {
        let mut terminals = Vec::with_capacity(quantities.len());
        for point in quantities {
            let (name, unit) = (point.name, point.unit);
            let key = format!("analog_in.{name}");
            let wired = settings.analog_in.get(name).ok_or_else(|| unwired(&key))?;
            if wired.unit != unit {
                let expected = format!("\"{unit}\", the unit of {name}");
                return Err(Fault::new(
                    format!("{key}.unit"),
                    format!("\"{}\"", wired.unit),
                    expected,
                ));
            }
            let Place { module, channel } =
                self.take(&key, &wired.module, wired.channel, Terminals::AnalogIn)?;
            let gain = wired.gain;
            terminals.push((
                *point,
                AnalogTerminal {
                    module,
                    channel,
                    gain,
                },
            ));
        }
        Ok(terminals)
    }

    fn analog_out(
        &mut self,
        settings: &RigSettings,
        names: &[&'static str],
    ) -> Result<Vec<(&'static str, AnalogTerminal)>, Fault> {
        let mut terminals = Vec::with_capacity(names.len());
        for name in names {
            let key = format!("analog_out.{name}");
            let wired = settings
                .analog_out
                .get(*name)
                .ok_or_else(|| unwired(&key))?;
            let Place { module, channel } =
                self.take(&key, &wired.module, 0, Terminals::AnalogOut)?;
            let gain = wired.gain;
            terminals.push((
                *name,
                AnalogTerminal {
                    module,
                    channel,
                    gain,
                },
            ));
        }
        Ok(terminals)
    }

    fn channels(
        &mut self,
        section: &str,
        names: &[&'static str],
        wired: &BTreeMap<String, ChannelSettings>,
        kind: Terminals,
    ) -> Result<Vec<(&'static str, AnalogTerminal)>, Fault> {
        let mut terminals = Vec::with_capacity(names.len());
        for name in names {
            let key = format!("{section}.{name}");
            let point = wired.get(*name).ok_or_else(|| unwired(&key))?;
            let Place { module, channel } = self.take(&key, &point.module, point.channel, kind)?;
            terminals.push((
                *name,
                AnalogTerminal {
                    module,
                    channel,
                    gain: 1.0,
                },
            ));
        }
        Ok(terminals)
    }
}

fn unwired(key: &str) -> Fault {
    Fault::new(key, "nothing", "a module and a channel")
}

/// Two lines cannot share a port.
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

/// A beam is read by an event counter: a falling part is too quick for a scan.
fn check_beams(wiring: &Wiring, settings: &RigSettings) -> Result<(), Fault> {
    for bin in wiring.axis.bins() {
        let beam = wiring.axis.beam(bin);
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

/// A channel whose mask no act ever changes must be enabled from the start.
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

fn resolve_strokes(actuators: &BTreeMap<String, ActuatorSettings>) -> Result<StrokeLimits, Fault> {
    let limit = |name: &str| match actuators.get(name) {
        Some(settings) => Ok(Span::seconds(settings.timeout_ms / 1000.0)),
        None => Err(Fault::new(
            format!("actuator.{name}"),
            "nothing",
            "a time-out",
        )),
    };
    Ok(StrokeLimits {
        escapement: limit("escapement")?,
        pusher: limit("pusher")?,
        clamp: limit("clamp")?,
        probe_lift: limit("probe_lift")?,
        sort_z: limit("sort_z")?,
        gripper: limit("gripper")?,
        axis: limit("axis")?,
    })
}
