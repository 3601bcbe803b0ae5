//! Tests of the whole rig of `config/`: module settings, scan rate, safe outputs, reproducibility.

use std::path::PathBuf;

use rigsim::{Files, Options, SharedRig, SimError, wire};
use tokio::io::{AsyncReadExt, AsyncWriteExt, DuplexStream};
use virtual_time::within;

const MEASURE: usize = 0;
const MOTION: usize = 1;

fn options(seed: u64) -> Options {
    Options {
        files: Files::Directory(PathBuf::from(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../config"
        ))),
        world: None,
        seed,
        recipe: "jzc-22f-012".into(),
        parts: Some(3),
        reference_parts: false,
        faults: Vec::new(),
    }
}

fn rig(seed: u64, faults: &[&str]) -> SharedRig {
    let mut options = options(seed);
    options.faults = faults.iter().map(ToString::to_string).collect();
    rigsim::build(&options).expect("the default rig")
}

fn with_checksum(text: &str) -> Vec<u8> {
    let sum = text.bytes().fold(0u8, u8::wrapping_add);
    format!("{text}{sum:02X}").into_bytes()
}

/// Returns the reply without checksum; empty for no reply.
fn ask(rig: &SharedRig, line: usize, text: &str, at_us: u64) -> String {
    let Some(reply) = rig.exchange(line, &with_checksum(text), at_us) else {
        return String::new();
    };
    let text = String::from_utf8_lossy(&reply.bytes).into_owned();
    text[..text.len() - 3].to_owned()
}

#[test]
fn modules_follow_the_settings_of_the_rig_file() {
    let rig = rig(1, &[]);
    for (request, reply) in [
        ("$012", "!01080A62"),
        ("$016", "!0160"),
        ("$092", "!09080A62"),
        ("$096", "!0901"),
        ("$022", "!02320A42"),
        ("$062", "!06320A6E"),
        ("$072", "!07320A56"),
        ("$032", "!03500A40"),
        ("$042", "!04400A40"),
        ("$082", "!08400A40"),
        ("$052", "!05200A40"),
        ("$01M", "!017017F"),
        ("~022", "!0210A"),
        ("~042", "!0410A"),
        ("~082", "!0800A"),
    ] {
        assert_eq!(ask(&rig, MEASURE, request, 0), reply, "{request}");
    }
    assert_eq!(ask(&rig, MOTION, "$11M", 0), "!117051");
    assert_eq!(ask(&rig, MOTION, "~142", 0), "!1410A");
    assert_eq!(ask(&rig, MOTION, "$012", 0), "", "another line's module");
    assert_eq!(rig.eeprom_writes(), 0);
}

#[test]
fn the_reference_voltage_reads_within_the_stated_tolerances() {
    for seed in 0..20 {
        let rig = rig(seed, &[]);
        let reply = {
            ask(&rig, MEASURE, "$01580", 0);
            ask(&rig, MEASURE, "#017", 1_000_000)
        };
        let code = i16::from_str_radix(&reply[1..], 16).expect("a code");
        let volts = f64::from(code) / 32_768.0 * 10.0;
        // Tolerance: gain 0.1 %, offset 0.05 % of 10 V, reference 0.02 %, four steps of 12 bit for noise.
        assert!(
            (volts - 5.0).abs() < 0.005 + 0.005 + 0.001 + 0.02,
            "seed {seed}: {volts}"
        );
    }
}

#[test]
fn fast_polling_reads_the_same_conversion_again() {
    let rig = rig(1, &[]);
    assert_eq!(ask(&rig, MEASURE, "$01580", 0), "!01");
    let mut changes = 0;
    let mut last = String::new();
    for millisecond in 1..=2_000 {
        let reply = ask(&rig, MEASURE, "#017", millisecond * 1_000);
        changes += u32::from(reply != last);
        last = reply;
    }
    // 150 conversions in two seconds; some repeat the previous code.
    assert!((40..=151).contains(&changes), "{changes}");
}

#[test]
fn watched_outputs_become_safe_after_host_silence() {
    let rig = rig(1, &[]);
    for line in [MEASURE, MOTION] {
        assert_eq!(ask(&rig, line, "~**", 0), "");
    }
    assert_eq!(ask(&rig, MEASURE, "#024000", 10_000), ">");
    assert_eq!(ask(&rig, MEASURE, "@040400", 10_000), ">");
    assert_eq!(ask(&rig, MOTION, "@140040", 10_000), ">");
    assert_eq!(ask(&rig, MOTION, "@14", 999_000), ">0040");
    assert_eq!(ask(&rig, MOTION, "@14", 1_000_000), ">0000");
    assert_eq!(ask(&rig, MEASURE, "@04", 1_000_000), ">0000");
    assert_eq!(ask(&rig, MEASURE, "~020", 1_000_000), "!0204");
    assert_eq!(ask(&rig, MEASURE, "#024000", 1_000_000), "!");
    // Three analog and three digital output modules stored the trip.
    assert_eq!(rig.eeprom_writes(), 6);
}

#[test]
fn a_fault_of_an_unknown_module_is_refused() {
    let build = |fault: &str| {
        let mut options = options(1);
        options.faults = vec![fault.into()];
        rigsim::build(&options).map(|_| ())
    };
    assert!(matches!(
        build("no_such"),
        Err(SimError::UnknownFault { .. })
    ));
    assert!(matches!(
        build("silence=nobody"),
        Err(SimError::FaultValue { .. })
    ));
    assert!(matches!(build("drop=2"), Err(SimError::FaultValue { .. })));
    assert!(build("silence=timer@3.5").is_ok());
}

#[test]
fn a_silence_starts_on_time_and_a_reset_shows() {
    let rig = rig(
        1,
        &["silence=timer@1", "reset=board_do@2", "wrong_type=rtd"],
    );
    assert_eq!(ask(&rig, MEASURE, "$03M", 999_000), "!037080");
    assert_eq!(ask(&rig, MEASURE, "$03M", 1_000_000), "");
    assert_eq!(ask(&rig, MEASURE, "$045", 1_000_000), "!041");
    assert_eq!(ask(&rig, MEASURE, "@040001", 1_500_000), ">");
    assert_eq!(ask(&rig, MEASURE, "$045", 1_999_999), "!040");
    assert_eq!(ask(&rig, MEASURE, "$045", 2_000_000), "!041");
    assert_eq!(ask(&rig, MEASURE, "@04", 2_000_000), ">0000");
    assert_eq!(ask(&rig, MEASURE, "$05M", 2_000_000), "!057000");
}

async fn poll(mut port: DuplexStream, requests: &'static [&'static str], rounds: usize) -> Vec<u8> {
    let mut seen = Vec::new();
    let mut bytes = [0u8; 256];
    for round in 0..rounds {
        let mut request = with_checksum(requests[round % requests.len()]);
        request.push(b'\r');
        port.write_all(&request).await.expect("a stream");
        // Longer than any reply takes: a broadcast or a lost reply.
        let reply = within(40_000, port.read(&mut bytes)).await;
        if let Some(count) = reply {
            seen.extend_from_slice(&bytes[..count.expect("a stream")]);
        }
    }
    seen
}

fn session(seed: u64, faults: &[&str]) -> (Vec<u8>, Vec<u8>) {
    let replies = virtual_time::block_on(async {
        let mut ports = wire::in_process(&rig(seed, faults)).into_iter();
        let mut port = || ports.next().expect("a line").1;
        let measure = poll(
            port(),
            &["#015", "#090", "@040101", "#024000", "#030", "@08", "~**"],
            700,
        );
        let motion = poll(
            port(),
            &["@11", "@12", "@130010", "@140050", "@11", "~**"],
            600,
        );
        tokio::join!(measure, motion)
    });
    replies.expect("a runtime")
}

#[test]
fn one_seed_gives_the_same_bytes_on_both_lines() {
    let first = session(5, &[]);
    assert!(first.0.len() > 3_000 && first.1.len() > 2_000);
    assert_eq!(first, session(5, &[]));
    assert_ne!(first.0, session(6, &[]).0);
    let faults = [
        "drop=0.02",
        "late=0.01",
        "flip=0.02",
        "truncate=0.02",
        "noise=0.02",
    ];
    assert_eq!(session(5, &faults), session(5, &faults));
    assert_ne!(first, session(5, &faults));
}
