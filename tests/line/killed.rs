//! Controllers that are killed or stopped in the middle of a test, over real pseudo-terminals: outputs become safe.
//!
//! The simulated rig judges in rig time, so that delays of this computer do not matter.

use crate::interruptions::send;
use crate::program::{Workshop, objects};
use serde_json::Value;
use std::collections::BTreeMap;
use std::io::{BufRead, BufReader};
use std::process::{Child, ChildStdout, Command};

/// The simulated rig on pseudo-terminals, printing changes of its outputs; dropping this value kills the rig.
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
    /// Starts the rig with its ports linked in `ports`; `faults` are further arguments.
    pub fn start(workshop: &Workshop, faults: &str) -> Self {
        let line = format!("sim --seed 1 --link ports --journal {faults}");
        Self::begin(workshop, &line).0
    }

    /// Starts the rig with this command line; returns it with the object that names its ports.
    pub fn begin(workshop: &Workshop, line: &str) -> (Self, Value) {
        // Without the limit a silent rig would block the test.
        let mut process = workshop.start_for("120", line);
        let told = BufReader::new(process.stdout.take().unwrap());
        let mut rig = Self { process, told };
        let ports = rig.next().expect("a rig that prints its ports");
        assert!(ports["lines"].is_object(), "{ports}");
        (rig, ports)
    }

    /// Returns the next event; `None` after its end.
    pub fn next(&mut self) -> Option<Value> {
        let mut line = String::new();
        let count = self.told.read_line(&mut line).unwrap();
        (count > 0).then(|| serde_json::from_str(&line).unwrap())
    }

    /// Returns the outputs of each digital module when the first watchdog expires.
    pub fn outputs_before_expiry(&mut self) -> BTreeMap<String, f64> {
        let told = std::iter::from_fn(|| self.next());
        let outputs = told
            .take_while(|told| told["type"] != "expired")
            .filter(|told| told["type"] == "output");
        outputs
            .map(|told| {
                let module = told["module"].as_str().unwrap().to_owned();
                (module, told["bits"].as_f64().unwrap())
            })
            .collect()
    }

    /// Returns the next `count` expiring watchdogs; fewer when the rig ends.
    pub fn expiries(&mut self, count: usize) -> Vec<Value> {
        let told = std::iter::from_fn(|| self.next());
        told.filter(|told| told["type"] == "expired")
            .take(count)
            .collect()
    }

    /// Waits for a motion and then for the coil drive. Returns false when a watchdog expires or the rig ends before.
    fn works(&mut self) -> bool {
        let moving = |told: &Value, module: &str| {
            told["type"] == "output" && told["module"] == module && told["bits"].as_u64() > Some(0)
        };
        let mut mechanism = false;
        while let Some(told) = self.next() {
            mechanism |= moving(&told, "mech_do_a") || moving(&told, "mech_do_b");
            if told["type"] == "expired" {
                return false;
            }
            if mechanism && moving(&told, "board_do") {
                return true;
            }
        }
        false
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

/// Most starts of a lot: on a busy computer the controller may be late for a watchdog or end with an alarm, and such a
/// start proves nothing.
pub const TRIES: usize = 20;

/// Starts a lot and kills its controller while the coil is driven. Returns the expired watchdogs, provided that all of
/// them expired after the kill.
fn killed_in_the_middle(workshop: &Workshop, attempt: usize, watched: usize) -> Option<Vec<Value>> {
    let mut rig = Rig::start(workshop, "");
    // Each attempt has its own history, so that an open lot does not refuse the next one.
    let mut controller = workshop.start(&format!(
        "--db attempt-{attempt}.db run --lot A --recipe jzc-22f-012 \
         --line measure=ports/measure --line motion=ports/motion"
    ));
    let works = rig.works();
    controller.kill().unwrap();
    controller.wait().unwrap();
    if !works {
        return None;
    }
    let expired = rig.expiries(watched);
    // A watchdog that expires before the kill has an earlier last request than the others.
    let mut last_requests = expired.iter().map(|told| &told["last_request_us"]);
    let last = last_requests.next_back()?;
    let after_the_kill = last_requests.all(|other| other == last);
    (after_the_kill && expired.len() == watched).then_some(expired)
}

#[test]
fn a_killed_controller_leaves_outputs_safe_by_watchdog() {
    let workshop = Workshop::new("killed-in-real-time");
    let mut left = watched(&workshop);
    assert!(left.len() >= 4, "{left:?}");
    let table: toml::Table = workshop.read("config/rig.toml").parse().unwrap();
    let limit_us = table["bus"]["host_watchdog_ms"].as_integer().unwrap() * 1_000;

    let expired = (0..TRIES)
        .find_map(|attempt| killed_in_the_middle(&workshop, attempt, left.len()))
        .expect("a machine with a second to spare");
    for told in expired {
        let safe = left
            .remove(told["module"].as_str().unwrap())
            .unwrap_or_else(|| panic!("twice: {told}"));
        let carries = told["carries"].as_f64().unwrap();
        // An analog output is off by its own offset, some millivolts.
        assert!((carries - safe).abs() < 0.01, "{told}, safe is {safe}");
        let after_us = told["t_us"].as_i64().unwrap() - told["last_request_us"].as_i64().unwrap();
        assert!(after_us <= limit_us, "{told}: limit {limit_us} us");
    }
}

/// Stops a lot twice while the coil is driven. Returns rig, status and output; `None` when the lot ended before.
fn stopped_twice(workshop: &Workshop) -> Option<(Rig, i32, String)> {
    let mut rig = Rig::start(workshop, "");
    let mut controller = workshop.start_heard(
        "run --lot A --recipe jzc-22f-012 --json \
         --line measure=ports/measure --line motion=ports/motion",
    );
    let works = rig.works();
    let mut log = BufReader::new(controller.stderr.take().unwrap()).lines();
    let heeded = ["once more stops at once", "stopping at once"].map(|answer| {
        send("INT", &controller);
        log.any(|row| row.unwrap().contains(answer))
    });
    let told = controller.wait_with_output().unwrap();
    let said = String::from_utf8(told.stdout).unwrap();
    (works && heeded == [true; 2]).then_some((rig, told.status.code().unwrap(), said))
}

#[test]
fn ctrl_c_twice_makes_outputs_safe_and_keeps_rows() {
    let (workshop, (mut rig, status, said)) = (0..TRIES)
        .find_map(|_| {
            let workshop = Workshop::new("ctrl-c-twice");
            stopped_twice(&workshop).map(|ended| (workshop, ended))
        })
        .expect("a machine with a second to spare");
    assert_eq!(status, 4, "{said}");
    // The controller itself switches off: no watchdog has expired.
    let safe = watched(&workshop);
    let left = rig.outputs_before_expiry();
    assert_eq!(left.get("board_do"), Some(&0.0), "{left:?}");
    for (module, bits) in left {
        let safe = safe.get(&module).copied().unwrap_or_default();
        assert_eq!(bits, safe, "{module}");
    }
    let told = objects(&said);
    assert_eq!(told.last().unwrap()["type"], "summary", "{told:?}");
    let count = |of: &str| workshop.count(&format!("SELECT count(*) FROM {of}"));
    let parts = i64::try_from(told.len() - 1).unwrap();
    assert_eq!(count("part WHERE kind = 'lot'"), parts);
    assert_eq!(count("run WHERE closed_at_us IS NULL"), 0);
    workshop.run("history check").with_status(0);
}
