//! The worst-case reaction to the emergency-stop contact.

use crate::rig::settings::RigSettings;
use crate::rig::wiring::Wiring;
use units::Span;

fn settings() -> RigSettings {
    toml::from_str(include_str!("../../../../../config/rig.toml")).unwrap()
}

#[test]
fn the_bound_adds_polls_one_failure_and_writes() {
    // Frames of 13 + 12 + 2 characters with 30 ms, eleven times (poll, repeated poll, name, request, time-out, name,
    // poll, time-out, name, two writes), and 12 characters with 30 ms twice, for silence; each wire time rounded up to
    // the microsecond.
    let bound = Wiring::resolve(&settings(), crate::dut::FIXTURES)
        .unwrap()
        .longest_reaction();
    assert_eq!(bound, Span(11 * (2_344 + 30_000) + 2 * (1_042 + 30_000)));
}

#[test]
fn slow_lines_and_analog_modules_lengthen_the_reaction() {
    let mut slow = settings();
    slow.line.get_mut("motion").unwrap().baud = 9600;
    slow.safety.estop_reaction_ms = 800.0;
    let bound = Wiring::resolve(&slow, crate::dut::FIXTURES)
        .unwrap()
        .longest_reaction();
    assert_eq!(bound, Span(11 * (28_125 + 30_000) + 2 * (12_500 + 30_000)));
    let mut shared = settings();
    let contact = shared.digital_in.get_mut("emergency_stop_ok").unwrap();
    (contact.module, contact.channel) = ("board_di".to_owned(), 13);
    let fault = Wiring::resolve(&shared, crate::dut::FIXTURES).unwrap_err();
    assert_eq!(fault.key, "safety.estop_reaction_ms");
}

#[test]
fn tolerated_lateness_follows_allowance_and_accepted_reaction() {
    // Allowance and accepted reaction of the file, ms; lateness that explains a missing reply, and slack.
    let table = [
        (30.0, 420.0, Span::ms(15), Span(2_132)),
        (30.0, 500.0, Span::ms(15), Span(82_132)),
        (20.0, 420.0, Span::ms(10), Span(132_132)),
    ];
    for (allowance_ms, accepted_ms, explaining, slack) in table {
        let mut settings = settings();
        settings.bus.digital_allowance_ms = allowance_ms;
        settings.safety.estop_reaction_ms = accepted_ms;
        let wiring = Wiring::resolve(&settings, crate::dut::FIXTURES).unwrap();
        assert_eq!(wiring.explaining_lateness(), explaining);
        assert_eq!(wiring.reaction_slack(), slack);
    }
}
