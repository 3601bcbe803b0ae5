//! Compares the modules on the lines with those of `rig.toml`.

use super::{text, wiring};
use crate::rig::commission::{judge, verification};

/// Judges the answer `reply` to `request`; `None` when verification sends no such request.
fn judged(request: &str, reply: &str) -> Option<Option<String>> {
    let wiring = wiring();
    let check = verification(&wiring)
        .into_iter()
        .find(|check| text(&check.command) == request)?;
    let reply = check
        .command
        .decode(format!("{reply}\r").as_bytes(), false)
        .unwrap();
    Some(judge(&wiring, &check, &reply).map(|mismatch| mismatch.to_string()))
}

#[test]
fn a_module_as_wired_passes() {
    for (request, reply) in [
        ("$012", "!01080A62"),
        ("$01M", "!017017F"),
        ("$016", "!0160"),
        ("$022", "!02320A42"),
        ("$062", "!06320A6E"),
        ("~062", "!0610A"),
        ("~060", "!0680"),
        ("~064", "!060000"),
        ("$132", "!13400A41"),
        ("~134S", "!130000"),
        ("$13M", "!13PRESS"),
        ("$115", "!111"),
    ] {
        assert_eq!(judged(request, reply), Some(None), "{request}");
    }
    assert_eq!(judged("$035", "!031"), None);
}

#[test]
fn a_mismatch_names_line_and_address() {
    for (request, reply, message) in [
        (
            "$052",
            "!05400A40",
            "line measure, address 05, module rtd: wrong module type at address: found type 40, expected type 20 of an I-7033",
        ),
        (
            "$12M",
            "!127043",
            "line motion, address 12, module mech_di_b: wrong module type at address: found 7043, expected I-7051",
        ),
        (
            "$016",
            "!01FF",
            "line measure, address 01, module coil_ai: channel mask: found FF, expected 60",
        ),
        (
            "$062",
            "!06320A56",
            "line measure, address 06, module ao_coarse: format byte: found 56, expected 6E",
        ),
        (
            "~130",
            "!1304",
            "line motion, address 13, module mech_do_a: host watchdog: found tripped, expected not tripped",
        ),
        (
            "~132",
            "!13064",
            "line motion, address 13, module mech_do_a: host watchdog: found off, 10.0 s, expected on, 1.0 s",
        ),
        (
            "~134S",
            "!130200",
            "line motion, address 13, module mech_do_a: safe value: found 0200, expected 0000",
        ),
    ] {
        assert_eq!(
            judged(request, reply),
            Some(Some(message.to_owned())),
            "{request}"
        );
    }
}

#[test]
fn verification_only_reads() {
    let wiring = wiring();
    for check in verification(&wiring) {
        assert!(!check.command.writes_eeprom(), "{}", text(&check.command));
        assert_eq!(
            check.command.address(),
            Some(wiring.module(check.module).address)
        );
    }
}
