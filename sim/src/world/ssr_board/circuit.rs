//! Circuit of the board: what is connected to the socket, and what each instrument finds at its terminals.

use super::network::{Limited, Network};
use super::{InputAt, Reference, SsrBoard};
use crate::scpi::circuit::{Drive, Reading, Terminal, over_resistor};
use crate::scpi::passive::clamped;
use crate::scpi::sources::PulseInput;
use crate::world::probes::Pins;
use crate::world::signal::Out;
use crate::world::specimen::{ProbeInterface, Specimen};
use crate::world::ssr::Ssr;

/// Time after which the socket has settled with anything connected to it, seconds.
const SETTLED_S: f64 = 1e6;

impl SsrBoard {
    /// Connects a source of an instrument from the present instant on.
    pub fn drive(&mut self, terminal: Terminal, drive: Drive) {
        match terminal {
            Terminal::Input => self.smu_in = drive,
            Terminal::Output => self.smu_out = drive,
            Terminal::Pulse => self.pulse = PulseInput::new(drive, self.now_us),
            Terminal::Line => self.line.drive(drive, self.now_us),
            Terminal::Load | Terminal::Shunt | Terminal::Socket | Terminal::Clamped => {}
        }
        self.touch();
    }

    /// Returns the voltage and current that an instrument or probe finds at a terminal; [`Terminal::Pulse`] is the
    /// control input.
    pub fn at(&self, terminal: Terminal, part: Option<&Specimen>) -> Reading {
        let part = part.and_then(Specimen::as_ssr);
        // A probe takes no current.
        let probe = |volts: f64| Reading { volts, amps: 0.0 };
        match terminal {
            Terminal::Pulse => self.input(part).1,
            Terminal::Input if self.commands.is_on(Out::DriveSelect) => {
                over_resistor(self.smu_in, f64::INFINITY)
            }
            Terminal::Input => self.input(part).1,
            Terminal::Output => self.at_smu_out(part),
            Terminal::Socket => probe(self.residual_v()),
            Terminal::Clamped => probe(clamped(self.residual_v())),
            Terminal::Load => Reading {
                volts: self.residual_v(),
                amps: self.load_a(part),
            },
            Terminal::Shunt => probe(self.load_a(part) * self.shunt_ohm()),
            Terminal::Line => Reading {
                volts: self.line.cycle().volts(self.now_us),
                amps: self.line_a(),
            },
        }
    }

    /// Returns the present phase of the line, 0 to 360 degrees.
    pub fn line_deg(&self) -> f64 {
        let rad = self.line.cycle().phase_rad(self.now_us);
        rad.to_degrees().rem_euclid(360.0)
    }

    /// Returns the current that the AC source delivers, amperes.
    fn line_a(&self) -> f64 {
        let circuit = self.alternating.as_ref();
        circuit.map_or(0.0, |it| it.at(self.now_us).amps)
    }

    /// Returns voltage and current of the control input, with their conditions.
    pub(super) fn input(&self, part: Option<&Ssr>) -> (InputAt, Reading) {
        let drive = match self.commands.is_on(Out::DriveSelect) {
            true => self.pulse.at(self.now_us),
            false => self.smu_in,
        };
        let part = part.filter(|it| self.meets_input(it));
        let drive = self.through_film(drive);
        let celsius = part.map(Ssr::celsius);
        let at = InputAt { drive, celsius };
        let known = self.input.filter(|(known, _)| *known == at);
        known.unwrap_or_else(|| {
            let open = || over_resistor(drive, f64::INFINITY);
            (at, part.map_or_else(open, |part| part.input(drive)))
        })
    }

    /// Adds the film on the probes to a source that does not sense at the pins.
    fn through_film(&self, drive: Drive) -> Drive {
        match drive {
            Drive::Voltage {
                volts,
                limit_a,
                source_ohm,
            } if source_ohm > 0.0 => Drive::Voltage {
                volts,
                limit_a,
                source_ohm: source_ohm + self.film_ohm + 2e-3 * self.table.contact_mohm,
            },
            other => other,
        }
    }

    /// Returns the light to which the present input current leads, relative to the threshold.
    pub(super) fn goal(&self, part: &Ssr) -> f64 {
        part.goal(self.input(Some(part)).1.amps)
    }

    fn meets_input(&self, part: &Ssr) -> bool {
        self.touching && part.pins().input()
    }

    /// Checks whether the output of the part is on the socket.
    pub(super) fn meets_output(&self, part: &Ssr) -> bool {
        let Pins { present, .. } = part.pins();
        self.touching && self.reference == Reference::Part && present[2] && present[3]
    }

    /// Returns the network at the socket without the source-measure unit.
    pub(super) fn network(&self, part: Option<&Ssr>) -> Network {
        let table = &self.table;
        let mut network = Network {
            farads: table.capacitance_nf * 1e-9,
            ..Network::default()
        };
        network.resistor(table.insulation_gohm * 1e9);
        if !self.commands.is_on(Out::BleedOpen) {
            network.resistor(table.bleed_ohm);
        }
        if self.connects(Out::ShortCheck) {
            network.source(self.sign() * table.short_check_v, table.short_check_ohm);
        }
        if self.is_shorted() {
            network.resistor(table.socket_short_mohm * 1e-3);
        }
        match self.reference {
            Reference::Part => {
                if let Some(part) = part.filter(|it| self.meets_output(it)) {
                    network.siemens += part.siemens();
                    network.farads += part.farads();
                }
            }
            Reference::Open => {}
            Reference::Short => network.resistor(table.reference_short_mohm * 1e-3),
            Reference::Resistor => network.resistor(table.reference_ohm),
        }
        network
    }

    /// Returns the network across the socket while no contactor is closed. It includes an AC output that a direct
    /// voltage has fired.
    pub(super) fn with_output(&self, part: Option<&Ssr>) -> Network {
        let mut network = self.network(part);
        let Some(part) = part.filter(|it| it.is_ac() && self.meets_output(it)) else {
            return network;
        };
        let free_v = network.after(self.socket_v, self.at_socket(), SETTLED_S);
        let sign = free_v.signum();
        let window = part.window(sign, false, false, 0.0);
        if window.is_some_and(|(least_v, most_v)| (least_v..=most_v).contains(&free_v.abs())) {
            network.source(sign * part.knee_v(sign), part.slope_ohm());
        }
        network
    }

    /// Returns the source-measure unit as the socket sees it; `None` while it is not connected.
    pub(super) fn at_socket(&self) -> Option<Limited> {
        let is_open = !self.connects(Out::SmuToOutput) || self.is_lead_open();
        if is_open || self.alternating.is_some() {
            return None;
        }
        let (volts, limit_a, own_ohm) = match self.smu_out {
            Drive::Voltage {
                volts,
                limit_a,
                source_ohm,
            } => (volts, limit_a, source_ohm),
            Drive::Current { amps, limit_v } => (limit_v.copysign(amps), amps.abs(), 0.0),
            Drive::Open | Drive::Sine { .. } | Drive::Pulses(_) => return None,
        };
        Some(Limited {
            volts: self.sign() * volts,
            ohms: own_ohm + self.series_ohm(),
            limit_a,
        })
    }

    /// Returns the resistance between the sense point of the unit and the socket, ohms.
    fn series_ohm(&self) -> f64 {
        match self.commands.is_on(Out::SmuLoad) {
            true => self.table.series_ohm + 2e-3 * self.table.contact_mohm,
            false => 0.0,
        }
    }

    /// Returns the current of the unit into the socket, amperes, from out1 to out2 through the part.
    fn smu_a(&self, part: Option<&Ssr>) -> f64 {
        let network = self.with_output(part);
        let source = self.at_socket();
        source.map_or(0.0, |it| network.current(self.socket_v, it))
    }

    /// Returns the current of all sources into the socket, amperes.
    fn load_a(&self, part: Option<&Ssr>) -> f64 {
        if self.alternating.is_some() {
            return self.line_a();
        }
        self.smu_a(part) + self.sign() * self.short_check_a()
    }

    /// Returns voltage and current at the sense point of the unit at the output.
    fn at_smu_out(&self, part: Option<&Ssr>) -> Reading {
        if self.at_socket().is_none() {
            return over_resistor(self.smu_out, f64::INFINITY);
        }
        let amps = self.smu_a(part);
        let volts = self.socket_v + amps * self.series_ohm();
        Reading {
            volts: self.sign() * volts,
            amps: self.sign() * amps,
        }
    }
}
