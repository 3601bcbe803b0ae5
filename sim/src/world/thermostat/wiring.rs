//! Names of the points of the chamber, and the terminals to which `rig.toml` wires them.

use std::collections::BTreeMap;

use crate::config::RigFile;
use crate::world::signal::vocabulary;
use crate::world::wiring::{Terminals, Wire, terminals};

vocabulary! {
    /// Signals to the controller.
    In {
        EmergencyStopOk = "emergency_stop_ok", DoorClosed = "door_closed",
        DoorLocked = "door_locked", LimiterOk = "limiter_ok", AirflowOk = "airflow_ok",
        MainsOk = "mains_ok",
    }
}

vocabulary! {
    /// Commands from the controller.
    Out {
        MainContactor = "main_contactor", Fan = "fan", DoorLockRelease = "door_lock_release",
        LampReady = "lamp_ready", LampTesting = "lamp_testing", LampUnload = "lamp_unload",
        Select0 = "socket_select_0", Select1 = "socket_select_1", Select2 = "socket_select_2",
        Select3 = "socket_select_3", Select4 = "socket_select_4", Select5 = "socket_select_5",
        Select6 = "socket_select_6", ContactCurrent = "contact_current",
    }
}

vocabulary! {
    /// Temperature sensors.
    Thermometer {
        Control = "control_temperature", Reference = "reference_temperature",
        Rack = "rack_temperature", Heater = "heater_temperature",
    }
}

vocabulary! {
    /// Analog outputs, 0 to 10 V for 0 to 100 %.
    Power { Heater = "heater_power", Vent = "vent_opening" }
}

vocabulary! {
    /// Analog inputs.
    Quantity { SocketDrop = "socket_drop" }
}

/// Bits that select a socket at the multiplexer, from the lowest.
pub const SELECT: [Out; 7] = [
    Out::Select0,
    Out::Select1,
    Out::Select2,
    Out::Select3,
    Out::Select4,
    Out::Select5,
    Out::Select6,
];

/// A digital input: a signal of the rig, or the contact of the socket at a place in the rack.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Input {
    /// A signal to the controller that is no contact of a socket.
    Signal(In),
    /// The contact of the socket at this place.
    Socket(usize),
}

/// Points by module and channel.
#[derive(Debug, Clone)]
pub struct Wiring {
    /// Digital inputs.
    pub inputs: Terminals<Input>,
    /// Digital outputs.
    pub outputs: Terminals<Out>,
    /// Temperature inputs.
    pub thermometers: Terminals<Thermometer>,
    /// Analog outputs.
    pub powers: Terminals<Power>,
    /// Analog inputs.
    pub quantities: Terminals<Quantity>,
}

impl Wiring {
    /// Resolves the points of the rig; ignores names that this rig does not have.
    pub fn new(rig: &RigFile) -> Self {
        let signal = |name: &str| In::from_name(name).map(Input::Signal);
        let mut inputs = terminals(&rig.digital_in, signal);
        for (place, socket) in rig.sockets.iter().enumerate() {
            let t = &socket.terminal;
            let wire = Wire {
                signal: Input::Socket(place),
                active_low: t.active_low,
                gain: t.gain,
            };
            inputs
                .entry(t.module.clone())
                .or_default()
                .push((t.channel, wire));
        }
        Self {
            inputs,
            outputs: terminals(&rig.digital_out, Out::from_name),
            thermometers: terminals(&rig.temperature, Thermometer::from_name),
            powers: terminals(&rig.analog_out, Power::from_name),
            quantities: terminals(&rig.analog_in, Quantity::from_name),
        }
    }
}

/// States of all digital commands.
#[derive(Debug, Clone, Default)]
pub struct Commands(BTreeMap<Out, bool>);

impl Commands {
    /// Checks whether a command is on.
    pub fn is_on(&self, out: Out) -> bool {
        self.0.get(&out).copied().unwrap_or(false)
    }

    /// Sets a command.
    pub fn set(&mut self, out: Out, on: bool) {
        self.0.insert(out, on);
    }

    /// Returns the number that the selection bits give to the multiplexer.
    pub fn selected(&self) -> u8 {
        let bits = SELECT.iter().enumerate();
        bits.fold(0, |number, (bit, out)| {
            number | u8::from(self.is_on(*out)) << bit
        })
    }
}
