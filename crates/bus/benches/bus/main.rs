//! `cargo bench -p bus`: speed and allocations of the parser, utilisation of a line with simulated modules in real
//! time, and ten million random frames. `--json` prints utilisation and random frames as figures, one line of JSON
//! each.

#![allow(missing_docs)]

mod bare;
mod busy;

use dcon::{
    self, Address, AlarmMode, AnalogIn, Command, Common, Counter, DataFormat, Digital, InputForm,
    TypeCode, UpTo,
};
use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use serde_json::{Value, json};
use std::hint::black_box;
use std::time::Instant;

#[global_allocator]
static ALLOC: divan::AllocProfiler = divan::AllocProfiler::system();

/// Number of random frames; the benchmark decodes each as a reply, and one in eight also as a request.
const FUZZED: u64 = 10_000_000;

fn main() {
    if std::env::args().any(|word| word == "--json") {
        busy::print_figures();
        let seconds = fuzz().seconds;
        figure(json!({
            "figure": "random frames decoded per second", "n": FUZZED, "value": FUZZED as f64 / seconds, "unit": "/s",
        }));
        return;
    }
    busy::print();
    let fuzzed = fuzz();
    println!(
        "{FUZZED} random frames, seed 1: no panic, {} replies taken, {} requests read, {:.0} s",
        fuzzed.taken, fuzzed.read, fuzzed.seconds
    );
    divan::main();
}

/// Prints a figure of this benchmark as a line of JSON.
fn figure(mut line: Value) {
    line["type"] = json!("figure");
    line["study"] = json!("bus");
    println!("{line}");
}

// ---- parser: divan prints MB/s, and allocations where there are any -------------------------------------------------

const VOLTS: InputForm = InputForm::eight(DataFormat::Engineering, TypeCode(0x08));

#[divan::bench]
fn parse_eight_channels(bencher: divan::Bencher) {
    parse(
        bencher,
        AnalogIn::ReadAll(VOLTS).to(Address(1)),
        ">+05.123+04.153+07.234-02.356+10.000-05.133+02.345+08.234",
    );
}

#[divan::bench]
fn parse_count(bencher: divan::Bencher) {
    let count = Counter::Read(UpTo::new(0).expect("0 is a counter"));
    parse(bencher, count.to(Address(3)), ">0000001E");
}

#[divan::bench]
fn parse_bits(bencher: divan::Bencher) {
    parse(bencher, Digital::ReadPort.to(Address(0x11)), ">BEDE");
}

fn parse(bencher: divan::Bencher, command: Command, text: &str) {
    let frame = sealed(text);
    bencher
        .counter(divan::counter::BytesCount::new(frame.len()))
        .bench_local(|| command.decode(black_box(&frame), true));
}

fn sealed(text: &str) -> Vec<u8> {
    format!("{text}{:02X}\r", dcon::checksum(text.as_bytes())).into_bytes()
}

// ---- random frames --------------------------------------------------------------------------------------------------

/// Counts of what the parser made of the random frames.
struct Fuzzed {
    /// Frames accepted as a reply.
    taken: u64,
    /// Commands parsed from the frames as requests.
    read: u64,
    /// Wall time.
    seconds: f64,
}

fn fuzz() -> Fuzzed {
    const LETTERS: &[u8] = b"!>?#$%@~0123456789ABCDEF+-. RDOCLHPSTGIM*";
    let asks = [
        Common::ReadConfig.to(Address(1)),
        Common::ReadWatchdog.to(Address(1)),
        AnalogIn::ReadAll(VOLTS).to(Address(1)),
        Digital::ReadSampled.to(Address(1)),
        Counter::ReadAlarm(AlarmMode::HighHigh).to(Address(1)),
        Counter::Read(UpTo::new(1).expect("1 is a counter")).to(Address(1)),
    ];
    let begun = Instant::now();
    // A fixed seed gives the same frames in every run.
    let mut random = SplitMix64::seed_from_u64(1);
    let mut frame = Vec::with_capacity(80);
    let (mut taken, mut read) = (0u64, 0u64);
    for turn in 0..FUZZED {
        frame.clear();
        let length = random.next_u64() % 24;
        for _ in 0..length {
            let draw = random.next_u64();
            // One byte in sixteen is random; the others are characters that the protocol uses.
            frame.push(if draw.is_multiple_of(16) {
                (draw >> 8) as u8
            } else {
                LETTERS[(draw >> 8) as usize % LETTERS.len()]
            });
        }
        let checksum = random.next_u64().is_multiple_of(8);
        if checksum {
            let sum = dcon::checksum(&frame);
            frame.extend(format!("{sum:02X}").bytes());
        }
        frame.push(b'\r');
        let ask = asks[(turn % asks.len() as u64) as usize];
        taken += u64::from(black_box(ask.decode(&frame, checksum)).is_ok());
        // Parsing a request tries every command; with only one frame in eight the run ends within minutes.
        if turn % 8 == 0 {
            read += black_box(dcon::decode_request(&frame[..frame.len() - 1])).len() as u64;
        }
    }
    Fuzzed {
        taken,
        read,
        seconds: begun.elapsed().as_secs_f64(),
    }
}
