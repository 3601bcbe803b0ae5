//! Circuit equations of the interface board: the value at every measuring point at this instant.

use super::Board;
use crate::world::probes::Contact;
use crate::world::signal::{Out, Quantity};
use crate::world::specimen::Specimen;

impl Board {
    /// Returns a quantity in its own unit, before the gain of its terminal; a coil voltage is divided by the factor of
    /// the supply range.
    pub fn quantity(&self, quantity: Quantity, part: Option<&Specimen>) -> f64 {
        match quantity {
            Quantity::CoilVoltage | Quantity::CoilVoltageFine => {
                self.coil_v(part) * self.divider / self.supply.range().factor
            }
            Quantity::CoilCurrent | Quantity::CoilCurrentFine | Quantity::CoilCurrentHigh => {
                self.coil_a(part)
            }
            Quantity::ContactCurrent => self.contact_a(part),
            Quantity::SupplyVoltage => self.supply.volts(),
            Quantity::ReferenceVoltage => self.reference_v,
            Quantity::ContactDrop => self.contact_v(part),
            Quantity::ResidualVoltage => f64::NAN,
        }
    }

    /// Clips a voltage to the range of an analog input.
    pub fn clip(&self, volts: f64) -> f64 {
        volts.clamp(-self.table.input_limit_v, self.table.input_limit_v)
    }

    /// Returns the voltage at which the zener clamps, V: it scales with the range of the supply.
    pub(super) fn zener_v(&self) -> f64 {
        self.table.zener_v * self.supply.range().factor
    }

    pub(super) fn senses(&self, contact: Contact, part: Option<&Specimen>) -> bool {
        self.touching
            && part.is_some_and(|it| it.pins().contact(contact) && self.detects_closed(it, contact))
    }

    /// Checks whether a contact is closed with a resistance low enough for the monitor.
    pub(super) fn detects_closed(&self, part: &Specimen, contact: Contact) -> bool {
        part.contact_mohm(contact).is_some_and(|mohm| {
            let ohm = mohm * 1e-3;
            ohm / (ohm + self.table.monitor_ohm) < self.table.monitor_threshold_pct / 100.0
        })
    }

    /// Returns the supply voltage that reaches the pins of a coil, behind the film on its probes. The model ignores the
    /// effect of the film on L/R, one percent at 4 ohm.
    pub(super) fn coil_input_v(&self, coil_ohm: f64) -> f64 {
        let share = 1.0 / (1.0 + self.film_ohm / coil_ohm);
        self.supply.limited_v(coil_ohm + self.film_ohm) * share
    }

    pub(super) fn coil_a(&self, part: Option<&Specimen>) -> f64 {
        if self.commands.is_on(Out::ReferenceCoil) {
            let volts = if self.driving {
                self.supply.limited_v(self.reference_coil_ohm)
            } else {
                0.0
            };
            return volts / self.reference_coil_ohm;
        }
        part.filter(|it| self.meets(it))
            .map_or(0.0, |it| it.input_a())
    }

    pub(super) fn coil_v(&self, part: Option<&Specimen>) -> f64 {
        let current = self.coil_a(part);
        match (self.driving, self.commands.is_on(Out::ReferenceCoil)) {
            (true, true) => current * self.reference_coil_ohm,
            (true, false) => self.coil_input_v(part.map_or(f64::INFINITY, |it| it.input_ohm())),
            (false, _) if current <= 0.0 => 0.0,
            (false, _) if self.clamp_diode => -self.table.diode_v,
            (false, _) => -self.zener_v(),
        }
    }

    /// Returns the resistance between the sense wires; `None` when open.
    pub(super) fn contact_ohm(&self, part: Option<&Specimen>) -> Option<f64> {
        if self.commands.is_on(Out::ReferenceContact) {
            return Some(self.reference_contact_ohm);
        }
        let contact = self.selected();
        let closed = self.senses(contact, part);
        part.filter(|_| closed)
            .and_then(|it| it.contact_mohm(contact))
            .map(|mohm| mohm * 1e-3)
    }

    pub(super) fn contact_a(&self, part: Option<&Specimen>) -> f64 {
        let ohm = self.contact_ohm(part).unwrap_or(f64::INFINITY);
        let size = match self.source_live {
            true => self.source_a.min(self.table.source_compliance_v / ohm),
            false => 0.0,
        };
        if self.switches.reverse { -size } else { size }
    }

    pub(super) fn source_limited(&self, part: Option<&Specimen>) -> bool {
        self.source_live && self.contact_a(part).abs() < self.source_a * 0.999
    }

    pub(super) fn contact_v(&self, part: Option<&Specimen>) -> f64 {
        let Some(ohm) = self.contact_ohm(part) else {
            return self.table.monitor_v;
        };
        let reference = self.commands.is_on(Out::ReferenceContact);
        let emf = part
            .filter(|_| !reference)
            .map_or(0.0, |it| it.emf_v() + self.emf_drift_v());
        let monitor_a = self.table.monitor_v / (self.table.monitor_ohm + ohm);
        (self.contact_a(part) + monitor_a) * ohm + emf
    }

    /// Returns the change of the EMF since the selected contact closed, volts.
    fn emf_drift_v(&self) -> f64 {
        let closed_us = self
            .closed_since_us
            .map_or(0.0, |since| self.now_us - since);
        self.table.emf_drift_uv_per_s * 1e-6 * closed_us * 1e-6
    }
}
