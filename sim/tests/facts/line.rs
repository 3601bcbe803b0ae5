//! Tests of lines in virtual time.

use rigsim::SharedRig;
use rigsim::wire;
use tokio::io::{AsyncReadExt, AsyncWriteExt, DuplexStream};
use virtual_time::{now_us, sleep_until, within};

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

#[test]
fn a_transaction_takes_its_characters_and_the_latency() {
    virtual_time::block_on(async {
        let mut port = open();
        let began_us = now_us();
        port.write_all(b"#010\r").await.expect("a stream");
        assert_eq!(reply(&mut port).await, b">+01.000\r");
        // 5 and 9 characters at 115200 baud, 2 ms.
        assert_eq!(now_us() - began_us, 435 + 2_000 + 782);
    })
    .expect("a runtime");
}

#[test]
fn fragments_and_two_requests_in_one_piece_are_answered() {
    virtual_time::block_on(async {
        let mut port = open();
        port.write_all(b"#0").await.expect("a stream");
        port.write_all(b"10\r@02\r").await.expect("a stream");
        assert_eq!(reply(&mut port).await, b">+01.000\r");
        assert_eq!(reply(&mut port).await, b">000F\r");
    })
    .expect("a runtime");
}

#[test]
fn an_absent_module_gives_no_answer() {
    virtual_time::block_on(async {
        let mut port = open();
        port.write_all(b"#090\r").await.expect("a stream");
        let silence = within(1_000_000, reply(&mut port)).await;
        assert!(silence.is_none());
        port.write_all(b"#010\r").await.expect("a stream");
        assert_eq!(reply(&mut port).await, b">+01.000\r");
    })
    .expect("a runtime");
}

#[test]
fn a_partial_request_is_forgotten_after_silence() {
    virtual_time::block_on(async {
        let mut port = open();
        port.write_all(b"#0").await.expect("a stream");
        let silence = within(200_000, reply(&mut port)).await;
        assert!(silence.is_none(), "half a request has no answer");
        port.write_all(b"@02\r").await.expect("a stream");
        assert_eq!(reply(&mut port).await, b">000F\r");
    })
    .expect("a runtime");
}

#[test]
fn a_lost_port_ends_the_stream_and_returns() {
    virtual_time::block_on(async {
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
        let began_us = now_us();
        assert_eq!(reply(&mut port).await, b"", "the stream ends");
        assert!(plug.open().is_none());
        let mut port = loop {
            sleep_until(now_us() + 10_000).await;
            match plug.open() {
                Some(port) => break port,
                None => assert!(now_us() < began_us + 4_000_000, "still away"),
            }
        };
        assert!(now_us() >= began_us + 2_900_000);
        port.write_all(b"@02\r").await.expect("a stream");
        assert_eq!(reply(&mut port).await, b">000F\r");
    })
    .expect("a runtime");
}
