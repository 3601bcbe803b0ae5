//! Faults of the chamber, its sensors, its hard-wired chain and its sockets, by name. `sim.toml` describes each.

use crate::world::signal::vocabulary;

vocabulary! {
    /// A fault; its value is the second of rig time at which it begins, or the number of a socket.
    Fault {
        ControlOpen = "control_open", ControlShort = "control_short",
        ControlStuck = "control_stuck", ControlDrift = "control_drift",
        ReferenceOpen = "reference_open", ReferenceShort = "reference_short",
        ReferenceStuck = "reference_stuck", ReferenceDrift = "reference_drift",
        RackOpen = "rack_open", RackShort = "rack_short",
        RackStuck = "rack_stuck", RackDrift = "rack_drift",
        ThermocoupleOpen = "thermocouple_open",
        HeaterOpen = "heater_open", HeaterHalf = "heater_half", PowerStuck = "ssr_stuck",
        FanStopped = "fan_stopped", FanSlow = "fan_slow", VentStuck = "vent_stuck",
        MainsLow = "mains_low", MainsOff = "mains_off",
        Door = "door", EmergencyStop = "estop",
        Limiter = "limiter", LimiterReset = "limiter_reset",
        SocketOpen = "socket_open",
    }
}

impl Fault {
    /// Checks whether the value of the fault is the number of a socket.
    pub fn is_of_socket(self) -> bool {
        self == Self::SocketOpen
    }
}

/// Trouble of a sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SensorTrouble {
    /// A wire is broken.
    Open,
    /// The wires touch.
    Short,
    /// The reading no longer changes.
    Stuck,
    /// The error grows with time.
    Drift,
}

/// Faults that have not begun yet, each with its instant in microseconds.
#[derive(Debug, Clone, Default)]
pub struct Pending(Vec<(u64, Fault)>);

impl Pending {
    /// Adds a fault.
    pub fn add(&mut self, at_us: u64, fault: Fault) {
        self.0.push((at_us, fault));
    }

    /// Removes and returns a fault that begins up to `t_us`.
    pub fn due(&mut self, t_us: u64) -> Option<Fault> {
        let place = self.0.iter().position(|(at_us, _)| *at_us <= t_us)?;
        Some(self.0.remove(place).1)
    }

    /// Removes all.
    pub fn clear(&mut self) {
        self.0.clear();
    }
}
