//! The hard-wired safety chain of the heater: limiter, airflow switch, door switch and emergency stop cut the
//! contactor, whatever the program does.

use super::table::SafetyTable;

/// Switches of the safety chain, lock of the door, and mains.
#[derive(Debug, Clone)]
pub struct Chain {
    table: SafetyTable,
    limiter_tripped: bool,
    /// Instant since which the fan has moved enough air, microseconds.
    airflow_since_us: Option<u64>,
    /// Instant until which a fault holds the door open, microseconds; the next field is that until which one holds the
    /// emergency stop.
    door_held_us: u64,
    emergency_stop_held_us: u64,
    /// True while the person has the door open.
    pub person_at_door: bool,
    /// False while the mains have failed.
    pub mains: bool,
    now_us: u64,
}

impl Chain {
    /// Creates a chain in which every switch but the airflow switch is closed.
    pub fn new(table: SafetyTable) -> Self {
        Self {
            table,
            limiter_tripped: false,
            airflow_since_us: None,
            door_held_us: 0,
            emergency_stop_held_us: 0,
            person_at_door: false,
            mains: true,
            now_us: 0,
        }
    }

    /// Advances to `now_us` with the speed of the fan and the temperature of the heater.
    pub fn step(&mut self, now_us: u64, fan: f64, heater_c: f64) {
        self.now_us = now_us;
        self.limiter_tripped |= heater_c >= self.table.limiter_c;
        match (fan >= self.table.airflow_from, self.airflow_since_us) {
            (true, None) => self.airflow_since_us = Some(now_us),
            (false, Some(_)) => self.airflow_since_us = None,
            (true, Some(_)) | (false, None) => {}
        }
    }

    /// Opens the door for the duration of the fault.
    pub fn open_door(&mut self) {
        self.door_held_us = self.now_us + (self.table.door_open_s * 1e6) as u64;
    }

    /// Presses the emergency stop for the duration of the fault.
    pub fn stop(&mut self) {
        self.emergency_stop_held_us = self.now_us + (self.table.emergency_stop_s * 1e6) as u64;
    }

    /// Trips the limiter.
    pub fn trip_limiter(&mut self) {
        self.limiter_tripped = true;
    }

    /// Resets the limiter by hand.
    pub fn reset_limiter(&mut self) {
        self.limiter_tripped = false;
    }

    /// Checks whether the limiter lets the contactor close.
    pub fn limiter_ok(&self) -> bool {
        !self.limiter_tripped
    }

    /// Checks whether the airflow switch is closed.
    pub fn airflow_ok(&self) -> bool {
        let wait_us = (self.table.airflow_s * 1e6) as u64;
        self.airflow_since_us
            .is_some_and(|since_us| self.now_us >= since_us + wait_us)
    }

    /// Checks whether the door is closed.
    pub fn door_closed(&self) -> bool {
        !self.person_at_door && self.now_us >= self.door_held_us
    }

    /// Checks whether the emergency stop is released.
    pub fn emergency_stop_ok(&self) -> bool {
        self.now_us >= self.emergency_stop_held_us
    }

    /// Checks whether the contactor may close.
    pub fn conducts(&self) -> bool {
        self.mains
            && self.limiter_ok()
            && self.airflow_ok()
            && self.door_closed()
            && self.emergency_stop_ok()
    }
}
