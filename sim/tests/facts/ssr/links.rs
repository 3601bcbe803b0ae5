//! Links of the instruments: streams in virtual time, sockets in real time, their faults, equal bytes under one seed.

use std::time::Duration;

use rigsim::{SharedRig, SimError, wire};
use tokio::io::{AsyncBufReadExt, AsyncReadExt, AsyncWriteExt, BufReader};

use super::hand::{Hand, options};

fn in_virtual_time<F: Future>(work: F) -> F::Output {
    virtual_time::block_on(work).expect("a runtime")
}

fn rig(faults: &[&str]) -> SharedRig {
    rigsim::build(&options(1, faults)).expect("a rig")
}

#[test]
fn plugs_and_lines_share_one_clock() {
    in_virtual_time(async {
        let rig = rig(&[]);
        rig.advance(5_000_000);
        let lines = wire::plugs(&rig);
        let plugs = rig.instrument_plugs();
        let names: Vec<&str> = plugs.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(
            names,
            [
                "digitizer",
                "pulse_source",
                "smu_in",
                "smu_out",
                "192.168.10.14:1234",
            ]
        );
        let mut smu = plugs[2].1.open().expect("a stream");
        let mut measure = lines[0].1.open().expect("a stream");
        smu.write_all(b"*IDN?\n").await.expect("a stream");
        let mut reply = String::new();
        let mut reader = BufReader::new(&mut smu);
        reader.read_line(&mut reply).await.expect("a reply");
        assert!(
            reply.starts_with("KEITHLEY INSTRUMENTS,MODEL 2450"),
            "{reply}"
        );
        let between_us = rig.now_us();
        assert!((5_001_000..5_010_000).contains(&between_us), "{between_us}");
        measure.write_all(b"$08MD9\r").await.expect("a stream");
        let mut bytes = [0; 32];
        let count = measure.read(&mut bytes).await.expect("a reply");
        assert!(bytes[..count].starts_with(b"!087041"), "{bytes:?}");
        assert!(rig.now_us() > between_us);
    });
}

#[test]
fn a_served_instrument_answers_over_tcp() {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build();
    runtime.expect("a runtime").block_on(async {
        let served = rig(&[]).serve_instruments().await.expect("links");
        let links = &served.links;
        let named = |wanted: &str| {
            let link = links.iter().find(|(name, _)| name == wanted);
            link.map(|(_, link)| link.clone()).expect("a link")
        };
        assert!(named("pulse_source").starts_with("serial:/dev/"));
        let place = named("smu_out");
        let place = place.strip_prefix("tcp:").expect("a socket");
        let mut host = tokio::net::TcpStream::connect(place).await.expect("a host");
        host.write_all(b"*ESE 7;*ESE?\n").await.expect("a host");
        let mut reply = [0; 2];
        let read = tokio::time::timeout(Duration::from_secs(5), host.read_exact(&mut reply));
        read.await.expect("in time").expect("a reply");
        assert_eq!(&reply, b"7\n");
    });
}

#[test]
fn a_fault_of_an_instrument_strikes_in_the_rig() {
    let mut hand = Hand::of(&options(1, &["over_range=smu_out:1"]));
    assert_eq!(hand.ask("smu_out", ":READ?"), "+9.9000000E+37");
    assert!(hand.value("smu_in", ":READ?").abs() < 1.0);
    let unknown = rigsim::build(&options(1, &["reply_lost=dmm:1"]));
    assert!(matches!(unknown, Err(SimError::FaultValue { .. })));
    hand.rig.inject("wrong_identity=smu_in:1").expect("a fault");
    assert_eq!(hand.ask("smu_in", "*IDN?"), "RELAYRIG,OTHER,0,0");
}

/// Measures the first part roughly; returns every byte that has come back.
fn session(seed: u64) -> Vec<u8> {
    let mut hand = Hand::of(&options(seed, &[]));
    hand.feed();
    hand.control(5.0);
    hand.value("smu_in", ":READ?");
    hand.load();
    hand.value("smu_out", ":READ?");
    super::figures::capture(&mut hand);
    hand.residual_v();
    hand.heard
}

#[test]
fn one_seed_gives_equal_bytes_from_instruments_too() {
    let first = session(5);
    assert!(first.len() > 100_000, "{}", first.len());
    assert_eq!(first, session(5));
    assert_ne!(first, session(6));
}

#[test]
fn one_step_or_many_give_equal_readings() {
    let readings = |steps: u32| {
        let mut hand = Hand::in_world(1, super::figures::GOOD);
        hand.feed();
        hand.load();
        hand.control(5.0);
        for _ in 0..steps {
            hand.wait(600.0 / f64::from(steps));
        }
        let warm_v = hand.value("smu_out", ":MEAS:VOLT?");
        hand.control(0.0);
        [warm_v, hand.value("smu_out", ":MEAS:CURR?")]
    };
    let (one, many) = (readings(1), readings(3_000));
    for (one, many) in one.into_iter().zip(many) {
        assert!((one - many).abs() <= 1e-6 * one.abs(), "{one} {many}");
    }
}
