//! Manual control of the terminals: a test sets outputs and reads inputs by name.

use super::*;
use crate::config::{RigFile, read_rig};

/// Controls the terminals by name; time in milliseconds.
pub(super) struct Hand {
    pub(super) world: World,
    pub(super) rig: RigFile,
    pub(super) bits: std::collections::BTreeMap<String, u16>,
    pub(super) t_us: u64,
    /// Factor of the supply range that the test has selected.
    factor: f64,
}

impl Hand {
    /// Builds a rig; selects the supply range of factor 1 if the rig has ranges.
    pub(super) fn new(options: WorldOptions) -> Self {
        let rig = read_rig(&options.files).unwrap();
        let ranged = !rig.supply_ranges.is_empty();
        let world = World::build(&options).unwrap();
        let mut hand = Self {
            world,
            rig,
            bits: std::collections::BTreeMap::new(),
            t_us: 0,
            factor: 1.0,
        };
        if ranged {
            hand.range(1);
        }
        hand
    }

    /// Commands a range of the supply and gives the relays time to follow.
    pub(super) fn range(&mut self, code: u8) {
        self.set("supply_range_0", code & 1 != 0);
        self.set("supply_range_1", code & 2 != 0);
        let ranges = self.rig.supply_ranges.iter();
        let range = ranges.clone().find(|range| range.code == code).unwrap();
        self.factor = range.factor;
        self.wait(6.0);
    }

    /// Returns the code that the range relays report.
    pub(super) fn range_set(&mut self) -> u8 {
        u8::from(self.is_on("supply_range_0_set")) | u8::from(self.is_on("supply_range_1_set")) << 1
    }

    pub(super) fn set(&mut self, point: &str, on: bool) {
        let terminal = self.rig.digital_out[point].clone();
        let bits = self.bits.entry(terminal.module.clone()).or_default();
        *bits = if on {
            *bits | 1 << terminal.channel
        } else {
            *bits & !(1 << terminal.channel)
        };
        self.world.digital_out(&terminal.module, *bits);
    }

    pub(super) fn wait(&mut self, ms: f64) {
        self.t_us += (ms * 1000.0) as u64;
        Plant::advance(&mut self.world, self.t_us);
    }

    pub(super) fn pulse(&mut self, point: &str, ms: f64) {
        self.set(point, true);
        self.wait(ms);
        self.set(point, false);
    }

    pub(super) fn is_on(&mut self, point: &str) -> bool {
        let terminal = self.rig.digital_in[point].clone();
        let high = self.world.digital_in(&terminal.module) >> terminal.channel & 1 == 1;
        high != terminal.active_low
    }

    /// Sets the level so that the supply gives this voltage in the commanded range.
    pub(super) fn level(&mut self, supply_v: f64) {
        self.world
            .analog_out("ao_level", 0, supply_v / 1.5 / self.factor);
    }

    pub(super) fn value(&mut self, point: &str) -> f64 {
        let t = self.rig.analog_in[point].clone();
        self.world.analog_in(&t.module, t.channel) / t.gain
    }

    pub(super) fn gate_ms(&mut self, point: &str) -> f64 {
        let t = self.rig.counter[point].clone();
        self.world.gate_open_us(&t.module, t.channel) / 1000.0
    }

    pub(super) fn axis(&mut self, point: u8) {
        for (i, name) in ["axis_point_0", "axis_point_1", "axis_point_2"]
            .into_iter()
            .enumerate()
        {
            self.set(name, point >> i & 1 == 1);
        }
        self.pulse("axis_drive", 900.0);
        assert!(self.is_on("axis_in_position"));
    }

    /// Feeds a part from the magazine to the nest, clamped, probes up.
    pub(super) fn feed(&mut self) {
        self.pulse("escapement_release", 300.0);
        assert!(self.is_on("pocket_present"));
        self.pulse("pusher_extend", 500.0);
        assert!(self.is_on("nest_present") && !self.is_on("pocket_present"));
        self.wait(500.0);
        self.pulse("clamp_close", 200.0);
        assert!(self.is_on("jaw_left_closed") && self.is_on("jaw_right_closed"));
        self.set("probe_lift", true);
        self.wait(250.0);
        assert!(self.is_on("probe_up") && self.is_on("probe_chain"));
    }

    /// Sorts the part from the nest into a bin; returns the axis to the nest.
    pub(super) fn sort(&mut self, point: u8) {
        self.set("axis_servo_on", true);
        self.axis(0);
        self.set("sort_z_lower", true);
        self.wait(400.0);
        self.pulse("gripper_close", 200.0);
        assert!(self.is_on("gripper_part"));
        self.set("probe_lift", false);
        self.wait(250.0);
        self.pulse("clamp_open", 200.0);
        self.set("sort_z_lower", false);
        self.wait(400.0);
        assert!(!self.is_on("nest_present") && self.is_on("sort_z_up"));
        self.axis(point);
        self.pulse("gripper_release", 500.0);
        self.axis(0);
    }
}

pub(super) fn options(reference_parts: bool) -> WorldOptions {
    WorldOptions {
        files: files(),
        seed: 3,
        recipe: "jzc-22f-012".into(),
        parts: Some(3),
        reference_parts,
        ..WorldOptions::default()
    }
}
