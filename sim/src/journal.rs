//! Journal of the outputs: changes of digital outputs, analog outputs that go on or off, expiries of host watchdogs,
//! faults that strike, overdriven coils, moves of the main contacts of a contactor, releases of the lock of a chamber and
//! closings of its contactor, and replies that this computer sends late.
//!
//! The journal records at the terminals, between modules and world, so that it holds the signals that the actuators
//! get. It is off until [`JournaledWorld::listen`].

use std::collections::BTreeMap;
use std::sync::mpsc::{self, Receiver, Sender};

use serde::Serialize;

use crate::rig::WorldModel;
use crate::scpi::circuit::Circuit;
use crate::terminal::Plant;
use crate::truth::{ChamberMove, ContactMove, Overdrive, WorldRecord};

/// One entry of the journal.
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
    /// The level of an analog output has crossed [`ON_V`].
    Level {
        /// Rig time, microseconds.
        t_us: u64,
        /// Identifier of the module.
        module: String,
        /// Channel.
        channel: u8,
        /// True when the level is now above.
        on: bool,
    },
    /// A fault has struck the running rig.
    Struck {
        /// Rig time, microseconds.
        t_us: u64,
        /// Text of the fault as requested.
        fault: String,
    },
    /// A host watchdog has expired, and the module has set its safe outputs.
    Expired {
        /// Rig time, microseconds.
        t_us: u64,
        /// Identifier of the module.
        module: String,
        /// Rig time at which the last request arrived on any line, microseconds.
        last_request_us: u64,
        /// Value of the outputs after the expiry: bits, or volts.
        carries: f64,
    },
    /// This computer sent the reply of a line too late, in real time.
    Late {
        /// Rig time at which the reply was due, microseconds.
        t_us: u64,
        /// Name of the line.
        line: String,
        /// How late the reply was, microseconds.
        late_us: u64,
    },
    /// A coil is driven while the supply is in a range above the commanded one.
    CoilOverdriven(Overdrive),
    /// The main contacts of a contactor have moved.
    Contact(ContactMove),
    /// The lock of a chamber was released, or the contactor of its heater has closed.
    Chamber(ChamberMove),
}

/// Level above which an analog output counts as on, V: more than the offset of a converter.
pub const ON_V: f64 = 0.01;

/// A world with a journal of its output terminals.
pub(crate) struct JournaledWorld {
    scene: Box<dyn WorldModel>,
    listener: Option<Sender<Entry>>,
    now_us: u64,
    last_request_us: u64,
    carries: BTreeMap<String, f64>,
    /// Analog outputs that are on.
    on: BTreeMap<(String, u8), bool>,
    /// Number of overdrives in the journal.
    overdrives: usize,
    /// Number of moves of contacts in the journal.
    moves: usize,
    /// Number of moves of a chamber in the journal.
    chamber_moves: usize,
    late: LateReplies,
}

/// Replies that this computer sent late, in real time.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct LateReplies {
    /// Number of late replies.
    pub count: u64,
    /// Lateness of the most delayed reply, microseconds.
    pub worst_us: u64,
}

impl JournaledWorld {
    pub(crate) fn new(scene: Box<dyn WorldModel>) -> Self {
        Self {
            scene,
            listener: None,
            now_us: 0,
            last_request_us: 0,
            carries: BTreeMap::new(),
            on: BTreeMap::new(),
            overdrives: 0,
            moves: 0,
            chamber_moves: 0,
            late: LateReplies::default(),
        }
    }

    /// Starts the journal; a later receiver replaces an earlier one.
    pub(crate) fn listen(&mut self) -> Receiver<Entry> {
        let (sender, receiver) = mpsc::channel();
        self.listener = Some(sender);
        receiver
    }

    /// Returns the record of the world, which also controls the faults of the world.
    pub(crate) fn record(&mut self) -> &mut dyn WorldRecord {
        &mut *self.scene
    }

    /// Notes the arrival of a request.
    pub(crate) fn note_request(&mut self, now_us: u64) {
        self.last_request_us = now_us;
    }

    /// Records that the watchdog of a module expires now.
    pub(crate) fn record_expiry(&mut self, module: &str) {
        self.send(Entry::Expired {
            t_us: self.now_us,
            module: module.to_owned(),
            last_request_us: self.last_request_us,
            carries: self.carries.get(module).copied().unwrap_or(0.0),
        });
    }

    /// Records that a fault strikes now.
    pub(crate) fn record_fault(&mut self, fault: &str) {
        self.send(Entry::Struck {
            t_us: self.now_us,
            fault: fault.to_owned(),
        });
    }

    /// Records that the reply of a line, due at `t_us`, was sent late.
    pub(crate) fn record_late(&mut self, line: &str, t_us: u64, late_us: u64) {
        self.late.count += 1;
        self.late.worst_us = self.late.worst_us.max(late_us);
        self.send(Entry::Late {
            t_us,
            line: line.to_owned(),
            late_us,
        });
    }

    /// Returns the late replies so far.
    pub(crate) fn late(&self) -> LateReplies {
        self.late
    }

    fn send(&self, entry: Entry) {
        if let Some(listener) = &self.listener {
            // When the receiver is gone, nobody needs further entries.
            let _ = listener.send(entry);
        }
    }

    /// Records the overdrives, moves of contacts and of a chamber since the last call.
    fn record_moves(&mut self) {
        let all = self.scene.overdrives();
        for overdrive in &all[self.overdrives..] {
            self.send(Entry::CoilOverdriven(*overdrive));
        }
        self.overdrives = all.len();
        let all = self.scene.contact_moves();
        for moved in &all[self.moves..] {
            self.send(Entry::Contact(*moved));
        }
        self.moves = all.len();
        let all = self.scene.chamber_moves();
        for moved in &all[self.chamber_moves..] {
            self.send(Entry::Chamber(*moved));
        }
        self.chamber_moves = all.len();
    }

    /// Records when an analog output goes on or off.
    fn switch(&mut self, module: &str, channel: u8, on: bool) {
        if self.listener.is_none() {
            return;
        }
        let before = self.on.insert((module.to_owned(), channel), on);
        if before.unwrap_or(false) != on {
            self.send(Entry::Level {
                t_us: self.now_us,
                module: module.to_owned(),
                channel,
                on,
            });
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

impl Plant for JournaledWorld {
    fn advance(&mut self, t_us: u64) {
        self.now_us = t_us;
        self.scene.advance(t_us);
        self.record_moves();
    }

    fn analog_in(&mut self, module: &str, channel: u8) -> f64 {
        self.scene.analog_in(module, channel)
    }

    fn analog_out(&mut self, module: &str, channel: u8, volts: f64) {
        // The first channel stands for the module.
        if channel == 0 {
            self.carry(module, volts);
        }
        self.switch(module, channel, volts.abs() > ON_V);
        self.scene.analog_out(module, channel, volts);
        self.record_moves();
    }

    fn digital_in(&mut self, module: &str) -> u16 {
        self.scene.digital_in(module)
    }

    fn digital_out(&mut self, module: &str, bits: u16) {
        if self.carry(module, f64::from(bits)) {
            self.send(Entry::Output {
                t_us: self.now_us,
                module: module.to_owned(),
                bits,
            });
        }
        self.scene.digital_out(module, bits);
        self.record_moves();
    }

    fn edges(&mut self, module: &str, channel: u8) -> u64 {
        self.scene.edges(module, channel)
    }

    fn gate_open_us(&mut self, module: &str, channel: u8) -> f64 {
        self.scene.gate_open_us(module, channel)
    }

    fn circuit(&mut self) -> Option<&mut dyn Circuit> {
        self.scene.circuit()
    }

    fn reference_clock_hz(&self) -> f64 {
        self.scene.reference_clock_hz()
    }
}
