//! `cargo bench --bench bus`: how fast the parser is and whether it allocates, how much of the time a line keeps busy
//! against the paced simulated modules, and ten million random frames.

#![allow(missing_docs)]

use relayrig::bus::{self, Answer, LineSettings, Pace, Request, SerialPorts, Wire};
use relayrig::dcon::{
    self, Address, AnalogIn, Channel, Command, Common, Counter, DataFormat, Digital, InputForm,
    TypeCode, UpTo,
};
use relayrig::units::{RigTime, Span};
use std::hint::black_box;
use std::time::Instant;
use tokio::sync::mpsc;

#[global_allocator]
static ALLOC: divan::AllocProfiler = divan::AllocProfiler::system();

/// Latency of a simulated module.
const LATENCY: Span = Span::ms(2);
/// Share of wire and module in the time that passes: the bars of the house.
const BARS: [(u32, f64); 2] = [(9_600, 0.95), (115_200, 0.87)];
/// Random frames, each to every kind of command and to the reading of requests.
const FUZZED: u64 = 10_000_000;

fn main() {
    efficiency();
    fuzz();
    divan::main();
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

// ---- efficiency -----------------------------------------------------------------------------------------------------

fn efficiency() {
    println!(
        "line kept busy by one-channel reads (9 + 5 characters, no checksum), modules of 2 ms, pseudo-terminal"
    );
    println!(
        "{:>7} {:>6} {:>10} {:>10} {:>10} {:>7} {:>5}",
        "baud", "asked", "median us", "p99 us", "bound us", "share", "bar"
    );
    for (baud, bar) in BARS {
        match busy(baud, if baud < 50_000 { 400 } else { 2_000 }) {
            Ok((share, mut each, bound)) => {
                each.sort_unstable();
                let at = |part: usize| each[each.len() * part / 100];
                println!(
                    "{baud:>7} {:>6} {:>10} {:>10} {:>10} {share:>7.3} {bar:>5}",
                    each.len(),
                    at(50),
                    at(99),
                    bound.0
                );
            }
            Err(error) => println!("{baud:>7} not measured: {error}"),
        }
    }
}

type Busy = (f64, Vec<u64>, Span);

/// Share, time of each transaction, and what wire and module alone take.
fn busy(baud: u32, count: usize) -> Result<Busy, Box<dyn std::error::Error>> {
    let file =
        std::env::temp_dir().join(format!("relayrig-bench-{}-{baud}.toml", std::process::id()));
    std::fs::write(
        &file,
        format!(
            "baud = {baud}\nlatency_ms = 2.0\n[[module]]\naddress = 1\nmodel = \"I-7017\"\nchecksum = false\n\
         format = \"engineering\"\nrange = \"08\"\ninputs = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]\n"
        ),
    )?;
    let rig = rigsim::build_bench(&file, &[])?;
    std::fs::remove_file(&file)?;
    let ptys = rigsim::pty::serve(&rig)?;
    let path = ptys.paths().remove(0).1.to_string_lossy().into_owned();
    let command = AnalogIn::ReadOne {
        channel: Channel::new(2).ok_or("channel")?,
        form: VOLTS,
    }
    .to(Address(1));
    let answers = tokio::runtime::Builder::new_multi_thread()
        .worker_threads(2)
        .enable_all()
        .build()?
        .block_on(asked(SerialPorts { path, baud }, command, count));
    let bound = Wire { baud }.time(5 + 9) + LATENCY;
    let good = answers
        .iter()
        .filter(|answer| answer.outcome.is_ok())
        .count();
    if good < count {
        return Err(format!("{} of {count} not answered", count - good).into());
    }
    let times: Vec<RigTime> = answers.iter().map(|answer| answer.asked_at).collect();
    let each: Vec<u64> = times
        .windows(2)
        .map(|pair| pair[1].since(pair[0]).0)
        .collect();
    let elapsed = times[count - 1].since(times[0]).0;
    Ok((
        bound.0 as f64 * each.len() as f64 / elapsed as f64,
        each,
        bound,
    ))
}

async fn asked(ports: SerialPorts, command: Command, count: usize) -> Vec<Answer> {
    let mut settings = LineSettings::new("bench", ports.baud);
    settings.checksum = false;
    let (ask, to_line) = mpsc::channel(1);
    let (from_line, mut answers) = mpsc::channel(1);
    tokio::spawn(bus::run_reopening(
        ports,
        settings,
        Pace::real(),
        to_line,
        from_line,
    ));
    tokio::spawn(async move {
        for ticket in 0..count as u64 {
            if ask
                .send(Request {
                    ticket,
                    command,
                    tries: 1,
                })
                .await
                .is_err()
            {
                return;
            }
        }
    });
    let mut got = Vec::with_capacity(count);
    while let Some(answer) = answers.recv().await {
        got.push(answer);
    }
    got
}

// ---- random frames --------------------------------------------------------------------------------------------------

/// Splitmix64: the same frames in every run.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }
}

fn fuzz() {
    const LETTERS: &[u8] = b"!>?#$%@~0123456789ABCDEF+-. RDOCLHPSTGIM*";
    let asks = [
        Common::ReadConfig.to(Address(1)),
        Common::ReadWatchdog.to(Address(1)),
        AnalogIn::ReadAll(VOLTS).to(Address(1)),
        Digital::ReadSampled.to(Address(1)),
        Counter::ReadAlarm.to(Address(1)),
        Counter::Read(UpTo::new(1).expect("1 is a counter")).to(Address(1)),
    ];
    let begun = Instant::now();
    let mut random = Random(1);
    let mut frame = Vec::with_capacity(80);
    let (mut taken, mut read) = (0u64, 0u64);
    for turn in 0..FUZZED {
        frame.clear();
        let length = random.next() % 24;
        for _ in 0..length {
            let draw = random.next();
            // One byte in sixteen is anything, the others are characters of the protocol.
            frame.push(if draw.is_multiple_of(16) {
                (draw >> 8) as u8
            } else {
                LETTERS[(draw >> 8) as usize % LETTERS.len()]
            });
        }
        let checksum = random.next().is_multiple_of(8);
        if checksum {
            let sum = dcon::checksum(&frame);
            frame.extend(format!("{sum:02X}").bytes());
        }
        frame.push(b'\r');
        let ask = asks[(turn % asks.len() as u64) as usize];
        taken += u64::from(black_box(ask.decode(&frame, checksum)).is_ok());
        // Reading a request tries every command; one frame in eight keeps the whole within minutes.
        if turn % 8 == 0 {
            read += black_box(dcon::readings(&frame[..frame.len() - 1])).len() as u64;
        }
    }
    println!(
        "{FUZZED} random frames, seed 1: no panic, {taken} replies taken, {read} requests read, {:.0} s",
        begun.elapsed().as_secs_f64()
    );
}
