//! Tests of instrument profiles: those that come with the program, and wrong ones with their messages.

use crate::{Folder, check_all, instrument_names, load_instrument};
use scpi::{Form, LinkAddress, Step};
use std::path::Path;
use units::Span;

fn folder() -> Folder {
    Folder::from(
        Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../../config")
            .as_path(),
    )
}

/// Loads the profile of the source and meter with one change, and checks the message.
fn refused(from: &str, to: &str, at: &str, message: &str) {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("instruments/smu-2450.toml");
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    let text = include_str!("../../../../config/instruments/smu-2450.toml");
    assert!(text.contains(from), "{from}");
    let text = text.replacen(from, to, 1);
    std::fs::write(&path, &text).unwrap();
    let line = text.lines().position(|it| it.contains(at)).unwrap() + 1;
    let error = load_instrument(&Folder::from(dir.path()), "smu-2450").unwrap_err();
    assert_eq!(
        error.to_string(),
        format!("{}:{line}: {message}", path.display())
    );
}

#[test]
fn every_profile_of_the_program_loads() {
    let names = instrument_names(&folder());
    assert_eq!(names.len(), 6, "{names:?}");
    for name in names {
        let profile = load_instrument(&folder(), &name).unwrap();
        assert!(!profile.safe().steps.is_empty(), "{name}");
    }
    check_all(&folder()).unwrap();
}

#[test]
fn a_program_gets_its_arguments() {
    let profile = load_instrument(&folder(), "digitizer-rigol").unwrap();
    let program = profile
        .program("waveform", &[("channel", 2.0), ("points", 20000.0)])
        .unwrap();
    assert_eq!(program.steps[0], Step::send(":WAV:SOUR CHAN2"));
    assert_eq!(program.steps[2], Step::send(":WAV:STOP 20000"));
    let (command, form, limit) = (
        ":WAV:DATA?".to_owned(),
        Form::Block(200_000),
        Some(Span::ms(3000)),
    );
    assert_eq!(
        program.steps[4],
        Step::Ask {
            command,
            form,
            limit,
            expect: None
        }
    );
    let wrong = |arguments: &[(&str, f64)]| {
        profile
            .program("waveform", arguments)
            .unwrap_err()
            .to_string()
    };
    assert_eq!(
        wrong(&[("channel", 5.0), ("points", 1.0)]),
        "program waveform, argument channel: found 5, expected a number from 1 to 4"
    );
    assert!(wrong(&[("channel", 1.0)]).contains("argument points: found nothing"));
    assert_eq!(
        wrong(&[("chanel", 1.0)]),
        "program waveform: found argument \"chanel\", expected channel or points"
    );
    assert!(
        wrong(&[("channel", 1.0), ("channel", 2.0)]).contains("channel: found 1 and 2, expected")
    );
    assert!(
        profile
            .program("wave", &[])
            .unwrap_err()
            .to_string()
            .contains("arm, capture, capture_all, capture_all_falling, capture_falling, complete,")
    );
}

#[test]
fn a_setting_is_proven_with_its_argument() {
    let profile = load_instrument(&folder(), "smu-2450").unwrap();
    let arguments = [("range_v", 20.0), ("limit_a", 0.05)];
    let program = profile.program("source_range", &arguments).unwrap();
    let Some(Step::Ask { expect, .. }) = program.steps.last() else {
        panic!("{program:?}");
    };
    assert_eq!(expect.as_deref(), Some("0.05"));
}

#[test]
fn an_address_decides_framing_and_reopening() {
    let profile = load_instrument(&folder(), "ac-source-61500").unwrap();
    let settings = |text: &str| profile.link_settings(&text.parse::<LinkAddress>().unwrap());
    assert!(settings("tcp:h:5025").reopen && !settings("serial:/dev/ttyS0:9600").reopen);
    assert_eq!(
        settings("gpib-tcp:h:1234:9").framing,
        scpi::Framing::Adapter(9)
    );
}

#[test]
fn a_wrong_profile_is_refused_with_its_line() {
    refused(
        "dialect = \"scpi\"",
        "dialect = \"tektronix\"",
        "dialect",
        "dialect: found \"tektronix\", expected \"scpi\", \"rigol\" or \"keysight\"",
    );
    refused(
        "error_depth = 32\n",
        "",
        "# Source and meter",
        "error_depth: found nothing, expected a whole number from 1 to 255",
    );
    refused(
        "latency_ms = 5.0",
        "latenci_ms = 5.0",
        "latenci_ms",
        "latenci_ms: found an unknown key, expected \"latency_ms\"?",
    );
    refused(
        "{ ask = \":READ?\", reply",
        "{ ask = \":READ\", reply",
        ":READ\"",
        "[program].current_at_level.steps[2].ask: found \":READ\", expected one query with ?, without ;",
    );
    refused(
        "VOLT {level_v}",
        "VOLT {level}",
        "{level}",
        "[program].current_at_level.steps[0].send: found \"level\", expected the name of an argument in braces",
    );
    refused(
        "expect = \"{limit_a}\"",
        "expect = \"{limit}\"",
        "{limit}",
        "[program].source_range.steps[2].ask: found \"limit\", expected the name of an argument in braces",
    );
    refused(
        "makers = [\"KEITHLEY\"]",
        "makers = []",
        "makers",
        "makers: found an empty list, expected at least one beginning",
    );
    refused(
        "{ send = \":OUTP ON\" }",
        "{ send = \":OUTP ON\", reply = \"number\" }",
        "reply = \"number\" }",
        "[program].current_at_level.steps[1].send: found \":OUTP ON\", expected no reply, expect, timeout_ms or \
         most_bytes beside send",
    );
    refused(
        "name = \"smu-2450\"",
        "name = \"smu\"",
        "name =",
        "name: found \"smu\", expected \"smu-2450\", as the file is called",
    );
}
