//! Tests of the instruments of `rig.toml`: their profiles and links, and wrong ones with their messages.

use super::plant::Copy;
use crate::Plant;

/// Two instruments; the folder has no profiles of its own.
const TWO: &str = "
[instrument.meter]
profile = \"dmm-34461a\"
link = \"tcp:192.168.10.14:5025\"

[instrument.source]
profile = \"smu-2450\"
link = \"gpib-tcp:192.168.10.15:1234:9\"
";

fn with(from: &str, to: &str) -> Copy {
    let text = super::changed(TWO, from, to);
    Copy::with("rig.toml", |rig| format!("{rig}{text}"))
}

fn refused(from: &str, to: &str, message: &str) {
    let found = with(from, to).refused();
    let (place, found) = found.split_once(": ").unwrap();
    assert!(place.starts_with("rig.toml:"), "{place}");
    assert_eq!(found, message);
}

#[test]
fn an_instrument_has_profile_and_link() {
    let copy = with("meter]", "multimeter]");
    let wiring = Plant::load(&copy.0.path().into()).unwrap().wiring;
    let names: Vec<&str> = wiring
        .instruments
        .iter()
        .map(|it| it.name.as_str())
        .collect();
    assert_eq!(names, ["multimeter", "source"]);
    let source = wiring.instrument_named("source").unwrap();
    let source = wiring.instrument(source);
    assert_eq!(source.link.gpib, Some(9));
    assert!(
        source
            .profile
            .program("current_at_level", &[("level_v", 4.0)])
            .is_ok()
    );
    assert_eq!(wiring.instrument_named("meter"), None);
}

#[test]
fn an_unknown_profile_is_refused() {
    refused(
        "dmm-34461a",
        "dmm-1",
        "[instrument].meter.profile: found \"dmm-1\", expected one of the profiles ac-source-61500, digitizer-keysight, \
         digitizer-rigol, dmm-34461a, pulse-source, smu-2450",
    );
}

#[test]
fn a_link_that_cannot_be_read_is_refused() {
    refused(
        "tcp:192.168.10.14:5025",
        "192.168.10.14",
        "[instrument].meter.link: found \"192.168.10.14\", expected tcp:HOST:PORT, serial:PATH:BAUD, \
         gpib-tcp:HOST:PORT:ADDR or gpib-serial:PATH:BAUD:ADDR",
    );
}

#[test]
fn two_instruments_never_share_a_link() {
    let message = |expected: &str, found: &str| {
        format!("[instrument].source.link: found \"{found}\", expected {expected} (line ")
    };
    for (link, expected) in [
        ("tcp:192.168.10.14:5025", "a link of its own"),
        ("gpib-tcp:192.168.10.14:5025:9", "an adapter of its own"),
    ] {
        let found = with("gpib-tcp:192.168.10.15:1234:9", link).refused();
        assert!(found.contains(&message(expected, link)), "{found}");
    }
}

#[test]
fn a_serial_port_is_one_link_at_any_rate() {
    let both = TWO
        .replace("tcp:192.168.10.14:5025", "serial:/dev/ttyUSB3:9600")
        .replace(
            "gpib-tcp:192.168.10.15:1234:9",
            "serial:/dev/ttyUSB3:115200",
        );
    let found = Copy::with("rig.toml", |rig| format!("{rig}{both}")).refused();
    assert!(found.contains("expected a link of its own"), "{found}");
}

#[test]
fn an_instrument_never_shares_the_port_of_a_line() {
    let found = with("tcp:192.168.10.14:5025", "serial:/dev/ttyUSB0:9600").refused();
    assert!(
        found.contains("expected a port that no line has"),
        "{found}"
    );
}
