//! What the outputs do: every change of a digital output, every host watchdog that expires, and what struck the rig.
//!
//! It is taken at the terminals, between modules and world, so that it shows what an actuator would have felt.
//! Off until somebody listens.

use std::collections::BTreeMap;
use std::sync::mpsc::{self, Receiver, Sender};

use serde::Serialize;

use crate::error::SimError;
use crate::rig::{Record, Scene};
use crate::terminal::Plant;
use crate::truth::BodyTruth;
use crate::world::WorldOptions;

/// One thing that happened.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Entry {
    /// The digital outputs of a module have changed.
    Output {
        /// Rig time, microseconds.
        t_us: u64,
        /// Identifier of the module.
        module: String,
        /// Bit n = channel n.
        bits: u16,
    },
    /// A fault has struck while the rig ran.
    Struck {
        /// Rig time, microseconds.
        t_us: u64,
        /// As it was asked for.
        fault: String,
    },
    /// A host watchdog has expired; the outputs stand as its module left them.
    Expired {
        /// Rig time, microseconds.
        t_us: u64,
        /// Identifier of the module.
        module: String,
        /// When the last request of any kind was heard on any line, microseconds.
        last_request_us: u64,
        /// What the terminals carry now: bits, or volts.
        carries: f64,
    },
}

/// The world as the modules see it, with somebody looking at the terminals.
pub(crate) struct Watched {
    scene: Box<dyn Scene>,
    listener: Option<Sender<Entry>>,
    now_us: u64,
    last_request_us: u64,
    carries: BTreeMap<String, f64>,
}

impl Watched {
    pub(crate) fn new(scene: Box<dyn Scene>) -> Self {
        Self {
            scene,
            listener: None,
            now_us: 0,
            last_request_us: 0,
            carries: BTreeMap::new(),
        }
    }

    /// From now on everything is told; a later listener takes the place of an earlier one.
    pub(crate) fn listen(&mut self) -> Receiver<Entry> {
        let (sender, receiver) = mpsc::channel();
        self.listener = Some(sender);
        receiver
    }

    /// A request has been heard.
    pub(crate) fn heard(&mut self, now_us: u64) {
        self.last_request_us = now_us;
    }

    /// The watchdog of a module has expired.
    pub(crate) fn expired(&mut self, module: &str) {
        self.tell(Entry::Expired {
            t_us: self.now_us,
            module: module.to_owned(),
            last_request_us: self.last_request_us,
            carries: self.carries.get(module).copied().unwrap_or(0.0),
        });
    }

    /// A fault strikes now.
    pub(crate) fn struck(&mut self, fault: &str) {
        self.tell(Entry::Struck {
            t_us: self.now_us,
            fault: fault.to_owned(),
        });
    }

    fn tell(&self, entry: Entry) {
        if let Some(listener) = &self.listener {
            // Somebody who has stopped listening misses nothing.
            let _ = listener.send(entry);
        }
    }

    fn carry(&mut self, module: &str, value: f64) -> bool {
        match self.carries.get_mut(module) {
            Some(carried) => std::mem::replace(carried, value) != value,
            None => {
                self.carries.insert(module.to_owned(), value);
                true
            }
        }
    }
}

impl Plant for Watched {
    fn advance(&mut self, t_us: u64) {
        self.now_us = t_us;
        self.scene.advance(t_us);
    }

    fn analog_in(&mut self, module: &str, channel: u8) -> f64 {
        self.scene.analog_in(module, channel)
    }

    fn analog_out(&mut self, module: &str, volts: f64) {
        self.carry(module, volts);
        self.scene.analog_out(module, volts);
    }

    fn digital_in(&mut self, module: &str) -> u16 {
        self.scene.digital_in(module)
    }

    fn digital_out(&mut self, module: &str, bits: u16) {
        if self.carry(module, f64::from(bits)) {
            self.tell(Entry::Output {
                t_us: self.now_us,
                module: module.to_owned(),
                bits,
            });
        }
        self.scene.digital_out(module, bits);
    }

    fn edges(&mut self, module: &str, channel: u8) -> u64 {
        self.scene.edges(module, channel)
    }

    fn gate_open_us(&mut self, module: &str, channel: u8) -> f64 {
        self.scene.gate_open_us(module, channel)
    }

    fn reference_clock_hz(&self) -> f64 {
        self.scene.reference_clock_hz()
    }
}

impl Record for Watched {
    fn truth(&mut self) -> Vec<serde_json::Value> {
        self.scene.truth()
    }

    fn crashes(&mut self) -> Vec<String> {
        self.scene.crashes()
    }

    fn strike(&mut self, fault: &str, value: Option<f64>) -> Result<(), SimError> {
        self.scene.strike(fault, value)
    }

    fn bodies(&mut self) -> Vec<BodyTruth> {
        self.scene.bodies()
    }

    fn fill(&mut self, options: &WorldOptions) -> Result<(), SimError> {
        self.scene.fill(options)
    }

    fn calm(&mut self) {
        self.scene.calm();
    }

    fn driven(&mut self) -> Vec<(u64, &'static str)> {
        self.scene.driven()
    }
}
