//! Lots on a rig with instruments: the program opens each instrument before anything moves, and refuses the lot when
//! another instrument answers.

use crate::program::Workshop;

/// Makes a workshop whose rig has one instrument; `more` are keys of the simulated one.
fn with_meter(name: &str, more: &str) -> Workshop {
    let workshop = Workshop::new(name);
    let appended = |file: &str, text: &str| format!("{}\n{text}", workshop.read(file));
    let link = "link = \"tcp:192.168.10.11:5025\"\n";
    let wired = format!("[instrument.meter]\nprofile = \"smu-2450\"\n{link}");
    workshop.write("config/rig.toml", &appended("config/rig.toml", &wired));
    let simulated = format!("[instrument.meter]\nmodel = \"2450\"\nat = \"input\"\n{more}");
    workshop.write("config/sim.toml", &appended("config/sim.toml", &simulated));
    workshop
}

const RUN: &str = "run --sim --recipe resistor-390 --count 2 --seed 1 --json";

#[test]
fn a_lot_opens_the_instruments_of_its_rig() {
    let workshop = with_meter("instruments_lot", "");
    for pace in ["virtual", "real"] {
        let said = workshop
            .run(&format!("{RUN} --lot {pace} --pace {pace}"))
            .with_status(0);
        assert_eq!(said.objects().last().unwrap()["alarms"], 0, "{said}");
    }
}

#[test]
fn another_instrument_ends_a_run_before_it_moves() {
    let workshop = with_meter("instruments_identity", "identity = \"ACME,D1,7,1.0\"\n");
    let said = workshop
        .run(&format!("{RUN} --lot A --pace virtual"))
        .with_status(3);
    assert_eq!(said.objects().last().unwrap()["parts"], 0, "{said}");
    let alarms = workshop.texts("SELECT code FROM alarm");
    assert_eq!(alarms, ["instrument_trouble"]);
    assert_eq!(workshop.count("SELECT count(*) FROM part"), 0);
}

#[test]
fn a_silent_instrument_ends_a_run_before_it_moves() {
    let workshop = with_meter("instruments_silent", "");
    let said = workshop.run(&format!(
        "{RUN} --lot A --pace virtual --fault reply_lost=meter:1"
    ));
    assert_eq!(said.with_status(3).objects().last().unwrap()["parts"], 0);
    let alarms = workshop.texts("SELECT code FROM alarm");
    assert_eq!(alarms, ["instrument_trouble"]);
}

#[test]
fn the_link_of_an_instrument_is_replaced_as_a_port_is() {
    let workshop = with_meter("instruments_line", "");
    let said = workshop.run("run --lot A --recipe resistor-390 --line meter=usb:1");
    assert!(
        said.stderr.contains("--line meter: found \"usb:1\""),
        "{said}"
    );
    said.with_status(2);
}

#[test]
fn an_instrument_of_the_rig_is_checked_by_its_name() {
    let workshop = with_meter("instruments_named", "");
    let other = workshop.run("instrument check --instrument source");
    assert!(other.stderr.contains("expected one of meter"), "{other}");
    other.with_status(2);
    workshop.change(
        "config/rig.toml",
        "tcp:192.168.10.11:5025",
        "tcp:127.0.0.1:1",
    );
    let said = workshop.run("instrument check --instrument meter --json");
    let rows = said.with_status(1).objects();
    assert_eq!(rows[0]["failure"]["code"], "link_down", "{rows:?}");
}

#[test]
fn the_doctor_looks_at_serial_ports_of_instruments() {
    let workshop = with_meter("instruments_doctor", "");
    workshop.change(
        "config/rig.toml",
        "tcp:192.168.10.11:5025",
        "serial:/dev/none:9600",
    );
    let said = workshop.run("doctor --json");
    let findings = said.objects();
    let port = findings
        .iter()
        .find(|it| it["subject"] == "/dev/none of instrument meter");
    assert_eq!(port.unwrap()["found"], "nothing", "{findings:?}");
}
