//! Tests of free-running converters, ramps and watchdogs on a bench with known signals.

use rigsim::bench;
use rigsim::rig::Rig;

fn rig(file: &str) -> Rig {
    bench::build_text(file).expect("a bench")
}

fn ask(rig: &mut Rig, request: &str, at_us: u64) -> String {
    let reply = rig.exchange(0, request.as_bytes(), at_us).expect("a reply");
    String::from_utf8_lossy(&reply.bytes).trim_end().to_owned()
}

#[test]
fn a_reply_comes_after_latency_and_its_characters() {
    let mut rig = rig("baud = 9600\n[[module]]\naddress = 1\nmodel = \"I-7017\"");
    let reply = rig.exchange(0, b"#010", 1_000_000).expect("a reply");
    // 2 ms and nine characters of ten bits.
    assert_eq!(reply.at_us, 1_000_000 + 2_000 + 9_375);
}

#[test]
fn a_ramp_moves_one_step_per_refresh() {
    let mut rig =
        rig("[[module]]\naddress = 1\nmodel = \"I-7021P\"\nslew = \"B\"\nformat = \"engineering\"");
    assert_eq!(ask(&mut rig, "#0110.000", 0), ">");
    assert_eq!(ask(&mut rig, "$018", 999), "!0100.000");
    assert_eq!(ask(&mut rig, "$018", 1_000), "!0100.064");
    assert_eq!(ask(&mut rig, "$018", 100_000), "!0106.400");
    assert_eq!(ask(&mut rig, "#0100.000", 100_500), ">");
    assert_eq!(ask(&mut rig, "$018", 101_000), "!0106.336");
}

#[test]
fn settings_write_the_eeprom_and_outputs_do_not() {
    let mut rig = rig("baud = 9600\n[[module]]\naddress = 1\nmodel = \"I-7043\"");
    for request in ["@01FFFF", "@01", "$016", "~010", "$012", "$015"] {
        ask(&mut rig, request, 0);
    }
    assert_eq!(rig.eeprom_writes(), 0);
    for request in ["~013164", "~015S", "~015P", "%0101400600", "~01OX"] {
        ask(&mut rig, request, 0);
    }
    assert_eq!(rig.eeprom_writes(), 5);
}

#[test]
fn a_watchdog_expires_without_requests() {
    let file = "[[module]]\naddress = 1\nmodel = \"I-7021P\"\nsafe = [0.0]\nwatchdog = { enabled \
                = true, timeout_s = 1.0 }";
    let mut rig = rig(file);
    assert_eq!(ask(&mut rig, "#0105.000", 60_000_000), ">");
    assert_eq!(rig.exchange(0, b"~**", 60_000_000), None);
    assert_eq!(ask(&mut rig, "$018", 60_999_999), "!0105.000");
    assert_eq!(ask(&mut rig, "$018", 61_000_000), "!0100.000");
    assert_eq!(ask(&mut rig, "#0105.000", 61_000_000), "!");
    assert_eq!(rig.eeprom_writes(), 1);
}

#[test]
fn two_modules_at_one_address_corrupt_both_replies() {
    let file = "[[module]]\naddress = 1\nmodel = \"I-7017\"\n[[module]]\naddress = 1\nmodel = \
                \"I-7060\"";
    let mut rig = rig(file);
    let reply = ask(&mut rig, "$01M", 0);
    assert_ne!(reply, "!017017");
    assert_ne!(reply, "!017060");
}
