//! Instruments with their links, and a bench: instruments around one circuit, from event to event.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::circuit::Circuit;
use super::device::Device;
use super::file::Link;
use super::instrument::Moment;
use super::port::{Out, Port};
use crate::error::SimError;
use crate::fault::instrument::InstrumentFaults;
use crate::shared::check_targets;

/// Instruments with their links and faults. Bench or rig keeps their clock and circuit.
pub struct Instruments {
    pub(crate) devices: Vec<Device>,
    pub(crate) ports: Vec<Port>,
    pub(crate) faults: InstrumentFaults,
}

impl Instruments {
    /// Returns the next instant at which an instrument acts, with its number.
    pub fn next(&self) -> Option<(u64, usize)> {
        let due = self.devices.iter().enumerate();
        due.filter_map(|(number, device)| Some((device.next_us()?, number)))
            .min()
    }

    /// Lets an instrument act at `now_us`, up to which the circuit has advanced, and go on until another instrument
    /// acts or `end_us` comes. Advances the circuit to the instant of its last act, and returns that instant.
    pub fn act(
        &mut self,
        number: usize,
        now_us: u64,
        end_us: u64,
        circuit: &mut dyn Circuit,
    ) -> u64 {
        let (before, rest) = self.devices.split_at(number);
        let others = before.iter().chain(&rest[1..]);
        let alone_us = others.filter_map(Device::next_us).fold(end_us, u64::min);
        let at = &mut Moment { now_us, circuit };
        self.devices[number].tick(at, alone_us, &mut self.faults);
        at.now_us
    }

    /// Returns every instrument from its front panel to remote control.
    pub fn release_panels(&mut self) {
        self.devices.iter_mut().for_each(Device::release_panel);
    }

    /// Checks that every instrument or adapter that a fault names exists.
    ///
    /// # Errors
    /// Fails at the first unknown name.
    pub fn check_targets(&self) -> Result<(), SimError> {
        let known = |target: &str| {
            self.devices.iter().any(|device| device.name == target)
                || self.ports.iter().any(|port| port.name == target)
        };
        let expected = "an instrument of rig.toml, or HOST:PORT of an adapter";
        check_targets(self.faults.targets(), expected, known)
    }

    /// Returns name and link of each port, in the order of their numbers.
    pub fn ports(&self) -> Vec<(String, Link)> {
        let port = |port: &Port| (port.name.clone(), port.link);
        self.ports.iter().map(port).collect()
    }
}

/// Instruments that links reach: a bench, or those of a rig.
pub trait Desk: Send + Sync {
    /// Advances instruments and circuit to `now_us`, then works with the instruments under the lock.
    fn at(&self, now_us: u64, work: &mut dyn FnMut(&mut Instruments));

    /// Works with the instruments as they are.
    fn look(&self, work: &mut dyn FnMut(&Instruments));

    /// Advances instruments and circuit.
    fn advance(&self, now_us: u64) {
        self.at(now_us, &mut |_| {});
    }

    /// Returns name and link of each port, in the order of their numbers.
    fn ports(&self) -> Vec<(String, Link)> {
        let mut ports = Vec::new();
        self.look(&mut |it| ports = it.ports());
        ports
    }

    /// Returns each instrument behind a port: its name, and its link with the port at `place` (`tcp:HOST:PORT`,
    /// `serial:PATH:BAUD`).
    fn links(&self, port: usize, place: &str) -> Vec<(String, String)> {
        let mut links = Vec::new();
        self.look(&mut |it| links = it.ports[port].links(place, &it.devices));
        links
    }

    /// Accepts a host on a port; returns `false` when a fault keeps the port busy.
    fn open(&self, port: usize, now_us: u64) -> bool {
        let mut open = false;
        self.at(now_us, &mut |it| {
            open = it.ports[port].open(now_us, &mut it.faults);
        });
        open
    }

    /// Ends the connection of the host.
    fn close(&self, port: usize, now_us: u64) {
        self.at(now_us, &mut |it| {
            it.ports[port].close(now_us, &mut it.devices, &mut it.faults);
        });
    }

    /// Takes bytes of the host.
    fn receive(&self, port: usize, bytes: &[u8], now_us: u64) {
        self.at(now_us, &mut |it| {
            it.ports[port].receive(bytes, now_us, &mut it.devices, &mut it.faults);
        });
    }

    /// Returns everything that has left the port up to `now_us`.
    fn due(&self, port: usize, now_us: u64) -> Vec<Out> {
        let mut due = Vec::new();
        self.at(now_us, &mut |it| {
            it.ports[port].collect(now_us, &mut it.devices, &mut it.faults);
            due = it.ports[port].due(now_us);
        });
        due
    }

    /// Returns the next instant at which something may leave the port.
    fn next_us(&self, port: usize) -> Option<u64> {
        let mut next_us = None;
        self.look(&mut |it| next_us = it.ports[port].next_us(&it.devices));
        next_us
    }
}

/// Instruments and circuit.
pub struct Bench {
    pub(super) instruments: Instruments,
    pub(super) circuit: Box<dyn Circuit>,
    pub(super) now_us: u64,
}

impl Bench {
    /// Advances instruments and circuit to `to_us`.
    pub fn advance(&mut self, to_us: u64) {
        while let Some((at_us, number)) = self.instruments.next().filter(|it| it.0 <= to_us) {
            self.now_us = self.now_us.max(at_us);
            self.circuit.advance(self.now_us);
            self.now_us = self
                .instruments
                .act(number, self.now_us, to_us, self.circuit.as_mut());
        }
        self.now_us = self.now_us.max(to_us);
        self.circuit.advance(self.now_us);
    }
}

/// A bench that its links share; a clone refers to the same bench.
#[derive(Clone)]
pub struct SharedBench(Arc<Mutex<Bench>>);

impl SharedBench {
    /// Shares a bench.
    pub fn new(bench: Bench) -> Self {
        Self(Arc::new(Mutex::new(bench)))
    }

    /// Locks the bench. A poisoned lock is safe: a link that panics leaves the bench between two events.
    pub fn lock(&self) -> MutexGuard<'_, Bench> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Desk for SharedBench {
    fn at(&self, now_us: u64, work: &mut dyn FnMut(&mut Instruments)) {
        let bench = &mut *self.lock();
        bench.advance(now_us);
        work(&mut bench.instruments);
    }

    fn look(&self, work: &mut dyn FnMut(&Instruments)) {
        work(&self.lock().instruments);
    }
}
