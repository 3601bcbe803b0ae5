//! Tests of lines in virtual time.

use std::time::Duration;

use rigsim::SharedRig;
use rigsim::wire;
use tokio::io::{AsyncReadExt, AsyncWriteExt, DuplexStream};
use tokio::time::{Instant, timeout};

const BENCH: &str = "baud = 115200\n[[module]]\naddress = 1\nmodel = \"I-7017\"\ninputs = \
                     [1.0]\n[[module]]\naddress = 2\nmodel = \"I-7060\"";

fn shared() -> SharedRig {
    SharedRig::new(rigsim::bench::build_text(BENCH).expect("a bench"))
}

async fn reply(port: &mut DuplexStream) -> Vec<u8> {
    let mut bytes = vec![0; 64];
    let count = port.read(&mut bytes).await.expect("a stream");
    bytes.truncate(count);
    bytes
}

fn open() -> DuplexStream {
    let mut ports = wire::in_process(&shared());
    ports.pop().expect("a line").1
}

#[tokio::test(start_paused = true)]
async fn a_transaction_takes_its_characters_and_the_latency() {
    let mut port = open();
    let begin = Instant::now();
    port.write_all(b"#010\r").await.expect("a stream");
    assert_eq!(reply(&mut port).await, b">+01.000\r");
    // 5 and 9 characters at 115200 baud, 2 ms: one tokio millisecond is one microsecond.
    let rig_us = begin.elapsed().as_millis();
    assert_eq!(rig_us, 435 + 2_000 + 782);
}

#[tokio::test(start_paused = true)]
async fn fragments_and_two_requests_in_one_piece_are_answered() {
    let mut port = open();
    port.write_all(b"#0").await.expect("a stream");
    port.write_all(b"10\r@02\r").await.expect("a stream");
    assert_eq!(reply(&mut port).await, b">+01.000\r");
    assert_eq!(reply(&mut port).await, b">000F\r");
}

#[tokio::test(start_paused = true)]
async fn an_absent_module_gives_no_answer() {
    let mut port = open();
    port.write_all(b"#090\r").await.expect("a stream");
    let silence = timeout(Duration::from_secs(1_000), reply(&mut port)).await;
    assert!(silence.is_err());
    port.write_all(b"#010\r").await.expect("a stream");
    assert_eq!(reply(&mut port).await, b">+01.000\r");
}

#[tokio::test(start_paused = true)]
async fn a_partial_request_is_forgotten_after_silence() {
    let mut port = open();
    port.write_all(b"#0").await.expect("a stream");
    let silence = timeout(Duration::from_secs(200), reply(&mut port)).await;
    assert!(silence.is_err(), "half a request has no answer");
    port.write_all(b"@02\r").await.expect("a stream");
    assert_eq!(reply(&mut port).await, b">000F\r");
}

#[tokio::test(start_paused = true)]
async fn a_lost_port_ends_the_stream_and_returns() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("bench.toml");
    std::fs::write(&file, BENCH).expect("a file");
    let faults = ["port_lost=bench@1..3".to_owned()];
    let rig = rigsim::build_bench(&file, &faults).expect("a bench");
    let (_, plug) = wire::plugs(&rig).remove(0);
    let mut port = plug.open().expect("a stream");
    port.write_all(b"#010\r").await.expect("a stream");
    assert_eq!(reply(&mut port).await, b">+01.000\r");
    assert!(plug.open().is_none(), "one stream at a time");
    let begin = Instant::now();
    assert_eq!(reply(&mut port).await, b"", "the stream ends");
    assert!(plug.open().is_none());
    // One second of rig time is a thousand seconds of tokio's clock.
    let mut port = loop {
        tokio::time::advance(Duration::from_secs(10)).await;
        match plug.open() {
            Some(port) => break port,
            None => assert!(begin.elapsed() < Duration::from_secs(4_000), "still away"),
        }
    };
    assert!(begin.elapsed() >= Duration::from_secs(2_900));
    port.write_all(b"@02\r").await.expect("a stream");
    assert_eq!(reply(&mut port).await, b">000F\r");
}
