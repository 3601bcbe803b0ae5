//! Controllers of the rig for solid-state relays are killed, stopped by a signal, or stopped by an instrument, in the
//! middle of a test, over real pseudo-terminals and sockets. Every output that connects a source to the socket must
//! then open.

use crate::interruptions::send;
use crate::killed::{Rig, TRIES};
use crate::program::Workshop;
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::process::Child;

/// Module with the contactors.
const MODULE: &str = "board_do";
/// Recipe of a DC part.
const DC: &str = "ssr-dc-60v-3a";
/// Recipe of an AC part.
const AC: &str = "ssr-ac-240v-5a-zc";
/// Instants of a test at which the controller is killed: when this output closes under this recipe.
const INSTANTS: [(&str, &str); 6] = [
    (DC, "short_check"),
    (DC, "smu_to_output"),
    (DC, "smu_load"),
    (DC, "drive_select"),
    (AC, "line_contactor"),
    (AC, "loop_contactor"),
];

/// Returns the bit of an output of the module.
fn bit(rig: &toml::Table, output: &str) -> u64 {
    let wired = &rig["digital_out"][output];
    assert_eq!(wired["module"].as_str(), Some(MODULE), "{output}");
    1 << wired["channel"].as_integer().unwrap()
}

/// Starts the rig and a controller that runs a lot of `recipe` on it; `db` is its history.
fn started(workshop: &Workshop, db: &str, recipe: &str, faults: &str) -> (Rig, Value, Child) {
    let own = "--config config/rigs/ssr";
    let line = format!("{own} sim --recipe {recipe} --seed 1 --journal {faults}");
    let (rig, ports) = Rig::begin(workshop, &line);
    let links = ["lines", "instruments"].map(|it| ports[it].as_object().unwrap());
    let links = links.into_iter().flatten();
    let links: Vec<String> = links
        .map(|(name, port)| format!("--line {name}={}", port.as_str().unwrap()))
        .collect();
    let links = links.join(" ");
    let run = format!("{own} --db {db} run --lot A --recipe {recipe} {links}");
    let controller = workshop.start_heard(&run);
    (rig, ports, controller)
}

/// Waits until an output closes. Returns false when a watchdog expires or the rig ends first.
fn closes(rig: &mut Rig, bit: u64) -> bool {
    let told = std::iter::from_fn(|| rig.next());
    let mut told = told.take_while(|it| it["type"] != "expired");
    told.any(|it| {
        let bits = it["bits"].as_f64().unwrap_or_default() as u64;
        it["type"] == "output" && it["module"] == MODULE && bits & bit != 0
    })
}

/// Starts a lot and kills its controller when an output has closed. Returns the expiry of the module's watchdog; `None`
/// when the lot ends first, or the watchdog expires before the kill.
fn killed(workshop: &Workshop, attempt: usize, (recipe, bit): (&str, u64)) -> Option<Value> {
    let db = format!("{recipe}-{bit}-{attempt}.db");
    let (mut rig, _, mut controller) = started(workshop, &db, recipe, "");
    let works = closes(&mut rig, bit);
    controller.kill().unwrap();
    controller.wait().unwrap();
    if !works {
        return None;
    }
    let mut expired = rig.expiries(3).into_iter();
    expired.find(|it| it["module"] == MODULE)
}

#[test]
fn a_killed_controller_leaves_contactors_open_at_every_instant() {
    let workshop = Workshop::new("ssr-killed");
    let table: toml::Table = workshop.read("config/rigs/ssr/rig.toml").parse().unwrap();
    let limit_us = table["bus"]["host_watchdog_ms"].as_integer().unwrap() * 1_000;
    for (recipe, output) in INSTANTS {
        let instant = (recipe, bit(&table, output));
        let expired = (0..TRIES)
            .find_map(|attempt| killed(&workshop, attempt, instant))
            .expect("a machine with a second to spare");
        assert_eq!(expired["carries"], 0.0, "{output}: {expired}");
        let after_us =
            expired["t_us"].as_i64().unwrap() - expired["last_request_us"].as_i64().unwrap();
        assert!(after_us <= limit_us, "{output}: {expired}");
    }
}

/// Stops a lot twice by signals while a source drives the socket. Returns the rig with its ports; `None` when the lot
/// ends first.
fn stopped(
    workshop: &Workshop,
    attempt: usize,
    (signal, bit): (&str, u64),
) -> Option<(Rig, Value)> {
    let db = format!("{signal}-{attempt}.db");
    let (mut rig, ports, mut controller) = started(workshop, &db, DC, "");
    let works = closes(&mut rig, bit);
    let mut log = BufReader::new(controller.stderr.take().unwrap()).lines();
    let heeded = ["once more stops at once", "stopping at once"].map(|answer| {
        send(signal, &controller);
        log.any(|row| row.unwrap().contains(answer))
    });
    let status = controller.wait_with_output().unwrap().status;
    let is_stopped = works && heeded == [true; 2] && status.code() == Some(4);
    is_stopped.then_some((rig, ports))
}

#[test]
fn a_stopped_controller_leaves_no_source_on() {
    let workshop = Workshop::new("ssr-stopped");
    let table: toml::Table = workshop.read("config/rigs/ssr/rig.toml").parse().unwrap();
    let bit = bit(&table, "smu_load");
    for signal in ["INT", "TERM"] {
        let (mut rig, ports) = (0..TRIES)
            .find_map(|attempt| stopped(&workshop, attempt, (signal, bit)))
            .expect("a machine with a second to spare");
        for name in ["smu_in", "smu_out"] {
            let link = ports["instruments"][name].as_str().unwrap();
            let mut ask = workshop.command("instrument send --link");
            let said = ask.args([link, ":OUTP?"]).output().unwrap();
            let said = String::from_utf8(said.stdout).unwrap();
            assert!(said.contains("< 0 "), "{signal}, {name}: {said}");
        }
        let left = rig.outputs_before_expiry();
        assert_eq!(left.get(MODULE), Some(&0.0), "{signal}: {left:?}");
    }
}

#[test]
fn an_instrument_in_trouble_leaves_contactors_open() {
    let workshop = Workshop::new("ssr-trouble-contactors");
    for (number, faults) in [
        "--fault local=smu_in:0.1@4",
        "--fault wrong_identity=smu_in:1@4 --fault closed_before=smu_in:0.1@4",
        "--fault power_cycle=smu_out:1@4",
    ]
    .into_iter()
    .enumerate()
    {
        let db = format!("{number}.db");
        let (mut rig, _, controller) = started(&workshop, &db, DC, faults);
        let status = controller.wait_with_output().unwrap().status;
        assert_eq!(status.code(), Some(3), "{faults}");
        // The controller itself has switched off, so no watchdog has expired.
        let left = rig.outputs_before_expiry();
        assert_eq!(left.get(MODULE), Some(&0.0), "{faults}: {left:?}");
    }
}
