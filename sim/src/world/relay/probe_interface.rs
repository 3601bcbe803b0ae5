//! Implements the probe interface for a relay, and its truth.

use super::Relay;
use super::defect::Defect;
use crate::truth::PartTruth;
use crate::world::probes::{Change, Contact, Pins, Supply};
use crate::world::specimen::ProbeInterface;

impl ProbeInterface for Relay {
    fn pins(&self) -> Pins {
        self.drawn.pins
    }

    fn input_ohm(&self) -> f64 {
        self.coil_ohm()
    }

    fn input_a(&self) -> f64 {
        self.coil_current_a()
    }

    fn drive(&mut self, t_us: f64, supply: Supply) {
        Relay::drive(self, t_us, supply);
    }

    fn advance(&mut self, t_us: f64) -> Option<Change> {
        Relay::advance(self, t_us)
    }

    fn contact_mohm(&self, contact: Contact) -> Option<f64> {
        self.is_closed(contact)
            .then(|| self.record.contact_mohm(contact))
    }

    fn source_on(&mut self, contact: Contact) {
        self.record.source_on(contact);
    }

    fn emf_v(&self) -> f64 {
        self.drawn.emf_v
    }

    fn truth(&self) -> PartTruth {
        let (drawn, record) = (&self.drawn, &self.record);
        let coil = drawn.coil_ohm;
        PartTruth {
            coil_resistance_ohm: coil.is_finite().then_some(coil),
            operate_voltage_v: Some(drawn.operate_v),
            release_voltage_v: Some(drawn.release_v),
            operate_time_ms: record.time_ms(Contact::No),
            release_time_ms: record.time_ms(Contact::Nc),
            operate_bounce_ms: record.bounce_ms(Contact::No),
            release_bounce_ms: record.bounce_ms(Contact::Nc),
            contact_resistance_no_mohm: record.mean_mohm(Contact::No),
            contact_resistance_nc_mohm: record.mean_mohm(Contact::Nc),
            operations: Some(record.operations()),
            defect: drawn.defect.map(Defect::name),
            levels: self.levels(),
            ..PartTruth::default()
        }
    }
}
