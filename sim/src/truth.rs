//! True values of each specimen, the path of its body, crashes and overdrives: the record that judges the controller.

use serde::Serialize;
use std::fmt;

use crate::error::SimError;
use crate::world::WorldOptions;
use crate::world::relay::Levels;
use crate::world::ssr::SsrTruth;

/// Facts of the world that no module reports, and control of its faults. The default methods suit a world of fixed
/// signals, which has neither parts nor faults.
pub trait WorldRecord {
    /// Returns one object per lot part that has entered the nest, in order.
    fn truth(&self) -> Vec<serde_json::Value> {
        Vec::new()
    }

    /// Returns a description of each crash (two bodies touch although they must not), in order of time.
    fn crashes(&self) -> Vec<String> {
        Vec::new()
    }

    /// Returns every overdrive of a coil, in order of time.
    fn overdrives(&self) -> &[Overdrive] {
        &[]
    }

    /// Returns every move of the main contacts of a contactor, in order of time.
    fn contact_moves(&self) -> &[ContactMove] {
        &[]
    }

    /// Returns each time the lock of a chamber was released or its contactor closed, in order of time.
    fn chamber_moves(&self) -> &[ChamberMove] {
        &[]
    }

    /// Removes and returns the texts that the code reader has sent so far.
    fn take_codes(&mut self) -> Vec<String> {
        Vec::new()
    }

    /// Activates a fault of the world; `value` is the number of a part.
    ///
    /// # Errors
    /// Fails when the fault is unknown or applies only to the start, or the number of a part is missing or needless.
    fn inject(&mut self, fault: &str, value: Option<f64>) -> Result<(), SimError> {
        let _ = value;
        Err(SimError::UnknownFault { name: fault.into() })
    }

    /// Replaces the parts in the magazine as an operator does; only recipe, number of parts and reference parts of the
    /// options apply.
    ///
    /// # Errors
    /// Fails when a configuration file is missing or wrong; the magazine then stays unchanged.
    fn refill(&mut self, options: &WorldOptions) -> Result<(), SimError> {
        let _ = options;
        Ok(())
    }

    /// Returns every body that has left the magazine, in order of leaving.
    fn bodies(&self) -> Vec<BodyTruth> {
        Vec::new()
    }

    /// Returns the start of each recent motion that an output caused: microseconds and actuator.
    fn motion_starts(&self) -> Vec<(u64, &'static str)> {
        Vec::new()
    }

    /// Forgets the bodies that have left the line.
    fn forget_finished(&mut self) {}

    /// Cancels the faults of the world that wait for their part or time; a fault that has struck keeps its effects.
    fn cancel_faults(&mut self) {}
}

/// True values of one lot part; `None` for a quantity that the part has not shown yet or cannot show.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct PartTruth {
    /// Order of entering the nest, from 1, without reference parts.
    pub seq: u64,
    /// Coil resistance at the reference temperature, ohm; `None` for an open coil.
    pub coil_resistance_ohm: Option<f64>,
    /// Quasi-static operate threshold at the reference temperature, V.
    pub operate_voltage_v: Option<f64>,
    /// Quasi-static release threshold at the reference temperature, V.
    pub release_voltage_v: Option<f64>,
    /// Time from drive on to first make of NO in the last full-voltage operation, ms.
    pub operate_time_ms: Option<f64>,
    /// Time from drive off to first make of NC in the last full-voltage release, ms.
    pub release_time_ms: Option<f64>,
    /// Open time of NO after its first make in the last full-voltage operation, ms.
    pub operate_bounce_ms: Option<f64>,
    /// Open time of NC after its first make in the last full-voltage release, ms.
    pub release_bounce_ms: Option<f64>,
    /// Mean resistance over the closures of NO that carried the source's current, milliohm.
    pub contact_resistance_no_mohm: Option<f64>,
    /// Mean resistance over the closures of NC that carried the source's current, milliohm.
    pub contact_resistance_nc_mohm: Option<f64>,
    /// Resistance of a resistor dummy at the reference temperature, ohm; `None` for an open one. Relays omit this key.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub resistance_ohm: Option<f64>,
    /// Figures of a solid-state relay. Other kinds omit these keys.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub ssr: Option<SsrTruth>,
    /// Number of full-voltage operations of a relay, from rest to the first make of NO. Dummies omit this key.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub operations: Option<u64>,
    /// Serial number that the code on the part holds. A rig without code reader omits this key.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub serial: Option<String>,
    /// Name of the defect, if any.
    pub defect: Option<&'static str>,
    /// Bin in which the body came to rest.
    pub landed_in: Option<String>,
    /// Rig time for which the relay's motion was computed at each level of detail: held in equilibrium, or all five
    /// states integrated.
    pub levels: Levels,
}

/// Drive of a coil in another supply range than the commanded one, at more volts than the commanded one would give.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Overdrive {
    /// Rig time, microseconds.
    pub t_us: u64,
    /// Code of the commanded range.
    pub commanded: u8,
    /// Code of the range that the supply really has.
    pub range: u8,
    /// Voltage of the supply without load, V.
    pub supply_v: f64,
}

/// Move of the main contacts of a contactor between the AC source and the socket.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ContactMove {
    /// Rig time, microseconds.
    pub t_us: u64,
    /// Name of the output that drives the coil.
    pub contactor: &'static str,
    /// True when the main contacts have closed, false when they have opened.
    pub closed: bool,
}

/// Release of the lock of a chamber, or closing of the contactor of its heater.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ChamberMove {
    /// Rig time, microseconds.
    pub t_us: u64,
    /// Name of the output that has gone on.
    pub output: &'static str,
    /// True temperature of the rack, degrees Celsius.
    pub rack_c: f64,
}

impl fmt::Display for Overdrive {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (s, volts) = (self.t_us as f64 / 1e6, self.supply_v);
        let (range, commanded) = (self.range, self.commanded);
        write!(
            f,
            "{volts:.2} V at {s:.3} s, supply range {range} in place of {commanded}"
        )
    }
}

/// Location of a body between magazine and bin.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Place {
    /// In the pocket, before the pusher.
    Pocket,
    /// In front of the moving pusher.
    Pusher,
    /// In the nest.
    Nest,
    /// Lifted by the fingers.
    Gripper,
    /// Falling down a chute.
    Air,
    /// At rest in this bin.
    Bin(String),
    /// At rest outside every bin.
    Floor,
}

/// One body, with its path; reference parts included.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyTruth {
    /// True for a reference part.
    pub is_reference: bool,
    /// True for a body that clung to the body before it: it followed the same path and was never tested.
    pub clung: bool,
    /// Places with the time of arrival, rig time in microseconds, in order of time.
    pub path: Vec<(u64, Place)>,
    /// True values of the part.
    pub part: PartTruth,
}

impl BodyTruth {
    /// Returns the place at an instant; `None` before the body left the magazine.
    pub fn at(&self, t_us: u64) -> Option<&Place> {
        let earlier = self.path.iter().rev();
        earlier
            .map(|(since, place)| (*since, place))
            .find(|(since, _)| *since <= t_us)
            .map(|(_, place)| place)
    }
}
