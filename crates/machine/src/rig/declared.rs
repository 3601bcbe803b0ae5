//! All points of this rig: those of the machine, those that a kind of device declares and `rig.toml` wires, the beams
//! that bins name, and the contacts of sockets. The place of a point in this order is its index in the tables of the
//! wiring.

use super::fault::Fault;
use super::point::{DigitalIn, DigitalInput, DigitalOut, Fixture, Quantity, Switch};
use super::rack;
use super::settings::RigSettings;

/// Names of the digital inputs in the order of the wiring: machine, fixtures, then beams or contacts of sockets.
pub(super) struct InputNames {
    pub names: Vec<String>,
    /// Number of inputs of the machine and the fixtures.
    pub before_beams: usize,
    /// Declared inputs that this rig lacks.
    missing: Vec<&'static str>,
}

impl InputNames {
    pub(super) fn of(settings: &RigSettings, fixtures: &[Fixture]) -> Self {
        let mut names: Vec<String> = DigitalIn::NAMES.iter().map(|it| (*it).into()).collect();
        let declared = fixtures.iter().flat_map(|it| it.digital_in).copied();
        add_wired(&mut names, settings, declared.clone());
        let before_beams = names.len();
        let beams = settings.bin.values().map(|bin| bin.beam.as_str());
        add_wired(&mut names, settings, beams);
        names.extend(settings.socket.keys().map(|it| rack::contact_name(it)));
        Self {
            names,
            before_beams,
            missing: declared
                .filter(|name| !settings.digital_in.contains_key(*name))
                .collect(),
        }
    }

    /// Returns the handle of a beam: an input of neither the machine nor a fixture.
    pub(super) fn beam(&self, name: &str) -> Option<DigitalInput> {
        let at = self.names.iter().position(|known| known == name)?;
        (at >= self.before_beams).then_some(DigitalInput::at(at))
    }

    /// Returns the handle of the contact of a socket.
    ///
    /// # Panics
    /// Panics for a socket that `rig.toml` lacks.
    pub(super) fn contact(&self, socket: &str) -> DigitalInput {
        let name = rack::contact_name(socket);
        match self.names.iter().rposition(|known| *known == name) {
            Some(at) => DigitalInput::at(at),
            None => panic!("no socket {socket}"),
        }
    }

    /// Checks that `rig.toml` wires no digital input of an unknown name.
    pub(super) fn check(&self, settings: &RigSettings) -> Result<(), Fault> {
        let contacts = settings.socket.len();
        let known = &self.names[..self.names.len() - contacts];
        let mut others = settings.digital_in.keys();
        let Some(name) = others.find(|name| !known.contains(name)) else {
            return Ok(());
        };
        let missing = self.missing.iter().map(|it| (*it).to_owned());
        let known = known.iter().cloned().chain(missing).collect();
        Err(Fault::unknown(format!("digital_in.{name}"), known))
    }
}

/// Adds those names of `more` that `rig.toml` wires, each once.
fn add_wired<'a>(
    names: &mut Vec<String>,
    settings: &RigSettings,
    more: impl Iterator<Item = &'a str>,
) {
    for name in more.filter(|name| settings.digital_in.contains_key(*name)) {
        if !names.iter().any(|known| known == name) {
            names.push(name.to_owned());
        }
    }
}

/// Points that kinds of device declare and this rig has, each name once.
pub(super) struct Declared<'a> {
    pub settings: &'a RigSettings,
    pub fixtures: &'a [Fixture],
}

impl Declared<'_> {
    pub(super) fn outputs(&self) -> Vec<Switch> {
        let machine = DigitalOut::NAMES.iter().map(|&name| Switch {
            name,
            traced: false,
        });
        let of_kinds = self.fixtures.iter().flat_map(|it| it.digital_out).copied();
        let wired = of_kinds.filter(|it| self.settings.digital_out.contains_key(it.name));
        unique(machine.chain(wired), |it| it.name)
    }

    pub(super) fn quantities(&self) -> Vec<Quantity> {
        let of_kinds = self.fixtures.iter().flat_map(|it| it.analog_in).copied();
        let wired = of_kinds.filter(|it| self.settings.analog_in.contains_key(it.name));
        unique(wired, |it| it.name)
    }

    pub(super) fn sources(&self) -> Vec<&'static str> {
        let wired = &self.settings.analog_out;
        self.names(|it| it.analog_out, |name| wired.contains_key(name))
    }

    pub(super) fn thermometers(&self) -> Vec<&'static str> {
        let wired = &self.settings.temperature;
        let of_kinds = self.names(|it| it.temperature, |name| wired.contains_key(name));
        let of_rack = self.settings.rack.as_ref().map(|_| rack::THERMOMETER);
        unique(of_kinds.into_iter().chain(of_rack), |name| name)
    }

    pub(super) fn counters(&self) -> Vec<&'static str> {
        let wired = &self.settings.counter;
        self.names(|it| it.counter, |name| wired.contains_key(name))
    }

    fn names(
        &self,
        of_kind: impl Fn(&Fixture) -> &'static [&'static str],
        is_wired: impl Fn(&str) -> bool,
    ) -> Vec<&'static str> {
        let names = self.fixtures.iter().flat_map(of_kind).copied();
        unique(names.filter(|name| is_wired(name)), |name| name)
    }
}

/// Keeps the first point of each name, because two kinds may declare the same point.
fn unique<T: Copy>(points: impl Iterator<Item = T>, name: impl Fn(T) -> &'static str) -> Vec<T> {
    let mut all: Vec<T> = Vec::new();
    for point in points {
        if !all.iter().any(|known| name(*known) == name(point)) {
            all.push(point);
        }
    }
    all
}
