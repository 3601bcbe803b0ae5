//! The controller killed in the middle of its work, over real pseudo-terminals: the modules make their outputs safe.
//!
//! Judged by the simulated rig in rig time, which follows the wall clock: how long this machine takes to notice
//! anything does not matter.

use crate::program::Workshop;
use serde_json::Value;
use std::collections::BTreeMap;
use std::io::{BufRead, BufReader};
use std::process::{Child, ChildStdout, Command};

/// The simulated rig on pseudo-terminals, telling what its outputs do; killed at the end.
pub struct Rig {
    process: Child,
    told: BufReader<ChildStdout>,
}

impl Drop for Rig {
    fn drop(&mut self) {
        // `timeout` hands the signal on to the rig.
        let _ = Command::new("kill")
            .arg(self.process.id().to_string())
            .status();
        let _ = self.process.wait();
    }
}

impl Rig {
    /// Links its ports in the folder `ports`; `faults` are further words of the command.
    pub fn start(workshop: &Workshop, faults: &str) -> Self {
        // A rig that tells nothing any more would keep the test waiting for ever.
        let mut process = workshop.start_for(
            "120",
            &format!("sim --seed 1 --link ports --journal {faults}"),
        );
        let told = BufReader::new(process.stdout.take().unwrap());
        let mut rig = Self { process, told };
        let lines = rig.next();
        assert!(lines["lines"].is_object(), "{lines}");
        rig
    }

    fn next(&mut self) -> Value {
        let mut line = String::new();
        let count = self.told.read_line(&mut line).unwrap();
        assert!(count > 0, "the rig told nothing more");
        serde_json::from_str(&line).unwrap()
    }
}

/// Modules with a host watchdog, and the safe value of their outputs.
fn watched(workshop: &Workshop) -> BTreeMap<String, f64> {
    let table: toml::Table = workshop.read("config/rig.toml").parse().unwrap();
    let modules = table["module"].as_table().unwrap().iter();
    let watched = modules
        .filter(|(_, module)| module.get("watchdog").and_then(toml::Value::as_bool) == Some(true));
    watched
        .map(|(id, module)| {
            let safe = module.get("safe").or(module.get("safe_outputs"));
            (id.clone(), safe.map_or(0.0, number))
        })
        .collect()
}

fn number(value: &toml::Value) -> f64 {
    match value {
        toml::Value::Integer(whole) => *whole as f64,
        toml::Value::Float(number) => *number,
        toml::Value::String(hex) => f64::from(u32::from_str_radix(hex, 16).unwrap()),
        toml::Value::Array(list) => list.first().map_or(0.0, number),
        other => panic!("{other} is no safe value"),
    }
}

/// Starts of a lot: on a machine that is busy with other things a watchdog may expire before the controller is killed,
/// which proves nothing.
const TRIES: usize = 20;

/// A lot is started, and its controller killed while the coil is driven and after the mechanism was; none when a
/// watchdog has expired before.
fn killed_in_the_middle(workshop: &Workshop) -> Option<Rig> {
    let mut rig = Rig::start(workshop, "");
    let mut controller = workshop.start(
        "run --lot A --recipe jzc-22f-012 --line measure=ports/measure --line motion=ports/motion",
    );
    let moving = |told: &Value, module: &str| {
        told["type"] == "output" && told["module"] == module && told["bits"].as_u64() > Some(0)
    };
    let mut mechanism = false;
    let alive = loop {
        let told = rig.next();
        mechanism |= moving(&told, "mech_do_a") || moving(&told, "mech_do_b");
        if told["type"] == "expired" || mechanism && moving(&told, "board_do") {
            break told["type"] != "expired";
        }
    };
    controller.kill().unwrap();
    controller.wait().unwrap();
    alive.then_some(rig)
}

#[test]
fn a_controller_that_is_killed_leaves_every_output_safe_within_the_watchdog_time() {
    let workshop = Workshop::new("killed-in-real-time");
    let safe = watched(&workshop);
    assert!(safe.len() >= 4, "{safe:?}");

    let table: toml::Table = workshop.read("config/rig.toml").parse().unwrap();
    let limit_us = table["bus"]["host_watchdog_ms"].as_integer().unwrap() * 1_000;
    let mut rig = (0..TRIES)
        .find_map(|_| killed_in_the_middle(&workshop))
        .expect("a machine with a second to spare");

    let mut left = safe.clone();
    let mut after_us = 0;
    while !left.is_empty() {
        let told = rig.next();
        if told["type"] != "expired" {
            continue;
        }
        let module = told["module"].as_str().unwrap();
        let safe = left
            .remove(module)
            .unwrap_or_else(|| panic!("twice: {told}"));
        let carries = told["carries"].as_f64().unwrap();
        // An analog output is off by its own offset, some millivolts.
        assert!((carries - safe).abs() < 0.01, "{told}, safe is {safe}");
        let expired_us = told["t_us"].as_i64().unwrap();
        after_us = after_us.max(expired_us - told["last_request_us"].as_i64().unwrap());
    }
    assert!(
        after_us <= limit_us,
        "safe only {after_us} us after the last request"
    );
}
