//! Applies the faults of the chamber at the instants at which they begin.

use super::OvenWorld;
use super::fault::{Fault, SensorTrouble};
use crate::config::ConfigError;
use crate::world::WorldOptions;
use crate::world::table::WorldTable;

impl OvenWorld {
    /// Adds the faults of the options; for a value of NaN the default of the table applies.
    pub(super) fn add_faults(
        &mut self,
        options: &WorldOptions,
        world: &WorldTable,
    ) -> Result<(), ConfigError> {
        let wrong = |name: &str, message: String| ConfigError::Fault {
            path: options.files.path("sim.toml"),
            key: format!("fault.{name}"),
            message,
        };
        for (name, value) in &options.faults {
            let fault = Fault::from_name(name).zip(world.fault.get(name));
            let Some((fault, spec)) = fault else {
                return Err(wrong(name, "no such fault of this rig".into()));
            };
            let value = if value.is_nan() { spec.default } else { *value };
            if !fault.is_of_socket() {
                self.faults.add((value.max(0.0) * 1e6) as u64, fault);
            } else if !self.break_wire(value) {
                return Err(wrong(
                    name,
                    format!("found {value}, expected the number of a socket"),
                ));
            }
        }
        Ok(())
    }

    /// Breaks a wire to a socket; returns false when the rack has no such number.
    pub(super) fn break_wire(&mut self, number: f64) -> bool {
        let now_us = self.now_us;
        number.fract() == 0.0 && number >= 0.0 && self.rack.break_wire(number as u64, now_us)
    }

    /// Lets a fault begin.
    pub(super) fn strike(&mut self, fault: Fault) {
        use Fault as F;
        use SensorTrouble as S;
        let safety = &self.table.safety;
        match fault {
            F::ControlOpen => self.fail(0, S::Open),
            F::ControlShort => self.fail(0, S::Short),
            F::ControlStuck => self.fail(0, S::Stuck),
            F::ControlDrift => self.fail(0, S::Drift),
            F::ReferenceOpen => self.fail(1, S::Open),
            F::ReferenceShort => self.fail(1, S::Short),
            F::ReferenceStuck => self.fail(1, S::Stuck),
            F::ReferenceDrift => self.fail(1, S::Drift),
            F::RackOpen => self.fail(2, S::Open),
            F::RackShort => self.fail(2, S::Short),
            F::RackStuck => self.fail(2, S::Stuck),
            F::RackDrift => self.fail(2, S::Drift),
            F::ThermocoupleOpen => self.fail(3, S::Open),
            F::HeaterOpen => self.broken.heater = 0.0,
            F::HeaterHalf => self.broken.heater = safety.half_power,
            F::PowerStuck => self.broken.power_stuck = true,
            F::FanStopped => self.broken.fan = 0.0,
            F::FanSlow => self.broken.fan = safety.slow_fan,
            F::VentStuck => self.broken.vent = Some(self.vent),
            F::MainsLow => self.broken.mains = 1.0 - safety.mains_low_pct / 100.0,
            F::MainsOff => self.chain.mains = false,
            F::Door => self.chain.open_door(),
            F::EmergencyStop => self.chain.stop(),
            F::Limiter => self.chain.trip_limiter(),
            F::LimiterReset => self.chain.reset_limiter(),
            // `break_wire` has broken the wire already, because only there the number is known.
            F::SocketOpen => {}
        }
    }

    fn fail(&mut self, gauge: usize, trouble: SensorTrouble) {
        let drift_k_per_h = self.table.sensors.drift_k_per_h;
        self.gauges[gauge].fail(trouble, drift_k_per_h);
    }
}
