//! Instruments around one circuit, stepped from event to event.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::circuit::Circuit;
use super::device::Device;
use super::port::{Out, Port};
use crate::fault::instrument::InstrumentFaults;

/// Instruments, circuit and links.
pub struct Bench {
    pub(super) devices: Vec<Device>,
    pub(super) ports: Vec<Port>,
    pub(super) circuit: Box<dyn Circuit>,
    pub(super) faults: InstrumentFaults,
    pub(super) now_us: u64,
}

impl Bench {
    /// Advances instruments and circuit to `to_us`.
    pub fn advance(&mut self, to_us: u64) {
        loop {
            let due = self.devices.iter().enumerate();
            let next = due
                .filter_map(|(number, device)| Some((device.next_us()?, number)))
                .min();
            let Some((at_us, number)) = next.filter(|(at_us, _)| *at_us <= to_us) else {
                break;
            };
            self.now_us = self.now_us.max(at_us);
            self.circuit.advance(self.now_us);
            self.devices[number].tick(self.now_us, self.circuit.as_mut(), &mut self.faults);
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

    /// Returns name and link of each port, in the order of their numbers.
    pub fn ports(&self) -> Vec<(String, super::file::Link)> {
        self.lock()
            .ports
            .iter()
            .map(|port| (port.name.clone(), port.link))
            .collect()
    }

    /// Returns each instrument behind a port: its name, and its link with the port at `place` (`tcp:HOST:PORT`,
    /// `serial:PATH:BAUD`).
    pub(super) fn links(&self, port: usize, place: &str) -> Vec<(String, String)> {
        let bench = self.lock();
        bench.ports[port].links(place, &bench.devices)
    }

    /// Accepts a host on a port; returns `false` when a fault keeps the port busy.
    pub fn open(&self, port: usize, now_us: u64) -> bool {
        let bench = &mut *self.lock();
        bench.advance(now_us);
        bench.ports[port].open(now_us, &mut bench.faults)
    }

    /// Ends the connection of the host.
    pub fn close(&self, port: usize, now_us: u64) {
        let bench = &mut *self.lock();
        bench.advance(now_us);
        bench.ports[port].close(now_us, &mut bench.devices, &mut bench.faults);
    }

    /// Takes bytes of the host.
    pub fn receive(&self, port: usize, bytes: &[u8], now_us: u64) {
        let bench = &mut *self.lock();
        bench.advance(now_us);
        bench.ports[port].receive(bytes, now_us, &mut bench.devices, &mut bench.faults);
    }

    /// Returns everything that has left the port up to `now_us`.
    pub fn due(&self, port: usize, now_us: u64) -> Vec<Out> {
        let bench = &mut *self.lock();
        bench.advance(now_us);
        bench.ports[port].collect(now_us, &mut bench.devices, &mut bench.faults);
        bench.ports[port].due(now_us)
    }

    /// Returns the next instant at which something may leave the port.
    pub fn next_us(&self, port: usize) -> Option<u64> {
        let bench = self.lock();
        bench.ports[port].next_us(&bench.devices)
    }
}
