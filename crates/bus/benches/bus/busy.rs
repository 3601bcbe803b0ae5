//! Utilisation of a line: the time that wire and modules need, divided by the elapsed time. The line is a
//! pseudo-terminal with simulated modules in real time, and always has a request waiting.
//!
//! After each reply the line pauses for two characters. No host can avoid this pause, whose cost depends on the length
//! of the frames. So the table shows each workload with the utilisation that the pause alone would allow (`bound`), and
//! with that of a bare client on the same pseudo-terminal in the same run (`peer`). No host can exceed the bound, and
//! on this machine hardly any exceeds the peer.

use super::{bare, figure};
use bus::{Answer, LineSettings, Pace, Request, Wire};
use dcon::{
    Address, AnalogIn, Channel, Command, Counter, DataFormat, Digital, InputForm, OutputWord,
    TypeCode, UpTo, Width,
};
use rigsim::pty::Rates;
use serde_json::json;
use std::error::Error;
use std::time::Duration;
use tokio::sync::mpsc;
use units::{RigTime, Span};

/// Time that a simulated module takes from the request to the beginning of its reply.
const LATENCY: Span = Span::ms(2);
/// Bars: baud rate, and least utilisation at this rate, 0 to 1.
const BARS: [(u32, f64); 2] = [(9_600, 0.95), (115_200, 0.87)];
/// Approximate time for which each row measures the line.
const MEASURED: Span = Span::ms(6_000);

const VOLTS: InputForm = InputForm::eight(DataFormat::Engineering, TypeCode(0x08));
const BENCH: &str = r#"latency_ms = 2.0
[[module]]
address = 1
model = "I-7017"
range = "08"
inputs = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]
[[module]]
address = 2
model = "I-7060"
[[module]]
address = 3
model = "I-7080"
"#;

/// A named list of commands that the line sends in turn.
struct Workload {
    name: &'static str,
    commands: Vec<Command>,
}

fn workloads() -> Vec<Workload> {
    let channel = Channel::new(2).expect("2 is a channel");
    let volts = Address(1);
    let one = AnalogIn::ReadOne {
        channel,
        form: VOLTS,
    };
    let port = Digital::ReadPort.to(Address(2));
    let relays = OutputWord::new(Width::One, 5).expect("5 is one digit");
    let count = |n| Counter::Read(UpTo::new(n).expect("0 and 1 are counters")).to(Address(3));
    vec![
        Workload {
            name: "#AAN, one channel",
            commands: vec![one.to(volts)],
        },
        Workload {
            name: "$AAA, eight in hex",
            commands: vec![AnalogIn::ReadAllHex(VOLTS).to(volts)],
        },
        Workload {
            name: "#AA, eight channels",
            commands: vec![AnalogIn::ReadAll(VOLTS).to(volts)],
        },
        Workload {
            name: "a test: #AA @AA @AAd 2 #AAN",
            commands: vec![
                AnalogIn::ReadAll(VOLTS).to(volts),
                port,
                Digital::Write(relays).to(Address(2)),
                count(0),
                count(1),
            ],
        },
    ]
}

/// A row of the printed table: one workload, measured at one baud rate.
struct Row {
    asked: usize,
    /// Mean number of characters in request and reply together.
    characters: f64,
    /// Utilisation of the line, 0 to 1.
    share: f64,
    /// Utilisation that a pause of two characters between transactions would allow without any other delay, 0 to 1.
    bound: f64,
    /// Utilisation of the bare client, 0 to 1.
    peer: f64,
    /// Times from one request to the next, microseconds, sorted.
    each_us: Vec<u64>,
}

/// Measures every workload at every baud rate and prints the utilisation as figures.
pub fn print_figures() {
    for (baud, bar) in BARS {
        for workload in workloads() {
            let row = measured(baud, &workload.commands).ok();
            let of = |value: fn(&Row) -> f64| row.as_ref().map(value);
            figure(json!({
                "figure": format!("use of a line at {baud} baud, {}", workload.name),
                "n": row.as_ref().map_or(0, |it| it.asked),
                "value": of(|it| it.share),
                "unit": "",
                "bound": of(|it| it.bound),
                "peer": of(|it| it.peer),
                "median_us": of(|it| it.each_us[it.each_us.len() / 2] as f64),
                "bar": format!(">= {bar}"),
            }));
        }
    }
}

/// Measures and prints every workload at every baud rate.
pub fn print() {
    println!(
        "line kept busy, no checksum, modules of 2 ms, pseudo-terminal; bound: only the pause of two characters, \
         peer: a bare client that spins"
    );
    println!(
        "{:>7} {:<28} {:>5} {:>6} {:>10} {:>8} {:>6} {:>6} {:>6} {:>5}",
        "baud",
        "workload",
        "asked",
        "chars",
        "median us",
        "p99 us",
        "bound",
        "peer",
        "share",
        "bar"
    );
    for (baud, bar) in BARS {
        for workload in workloads() {
            match measured(baud, &workload.commands) {
                Ok(row) => println!(
                    "{baud:>7} {:<28} {:>5} {:>6.1} {:>10} {:>8} {:>6.3} {:>6.3} {:>6.3} {bar:>5} {}",
                    workload.name,
                    row.asked,
                    row.characters,
                    row.each_us[row.each_us.len() / 2],
                    row.each_us[row.each_us.len() * 99 / 100],
                    row.bound,
                    row.peer,
                    row.share,
                    reached(&row, bar),
                ),
                Err(error) => println!("{baud:>7} {:<28} not measured: {error}", workload.name),
            }
        }
    }
}

fn reached(row: &Row, bar: f64) -> &'static str {
    if row.share >= bar {
        "met"
    } else if row.bound < bar {
        "out of reach"
    } else {
        "missed"
    }
}

fn measured(baud: u32, commands: &[Command]) -> Result<Row, Box<dyn Error>> {
    let wire = Wire { baud };
    let longest: Vec<u64> = commands
        .iter()
        .map(|command| (wire.time(command.longest_reply()) + LATENCY).0)
        .collect();
    let round = longest.iter().sum::<u64>();
    let count = (MEASURED.0 / round + 1) as usize * commands.len();
    let file =
        std::env::temp_dir().join(format!("relayrig-bench-{}-{baud}.toml", std::process::id()));
    std::fs::write(&file, format!("baud = {baud}\n{BENCH}"))?;
    let rig = rigsim::build_bench(&file, &[])?;
    std::fs::remove_file(&file)?;
    let ptys = rigsim::pty::serve(&rig, Rates::Ignored)?;
    let path = ptys.paths().remove(0).1.to_string_lossy().into_owned();
    let answers = tokio::runtime::Builder::new_multi_thread()
        .worker_threads(2)
        .enable_all()
        .build()?
        .block_on(exchange_all(&path, baud, commands, count));
    let requests: Vec<Vec<u8>> = commands.iter().cycle().take(count).map(written).collect();
    let peer = bare::exchange_all(&path, wire, &requests)?;
    row(wire, &answers, count, peer)
}

fn row(
    wire: Wire,
    answers: &[Answer],
    count: usize,
    peer: Duration,
) -> Result<Row, Box<dyn Error>> {
    let good = answers.iter().filter(|answer| answer.outcome.is_ok());
    let bad = count - good.count();
    if bad > 0 {
        return Err(format!("{bad} of {count} not answered").into());
    }
    let times: Vec<RigTime> = answers.iter().map(|answer| answer.requested_at).collect();
    let mut each_us: Vec<u64> = times
        .windows(2)
        .map(|pair| pair[1].since(pair[0]).0)
        .collect();
    let elapsed = times[count - 1].since(times[0]).0;
    // The last answer does not count, because no request follows it.
    let characters: Vec<usize> = answers[..count - 1].iter().map(characters).collect();
    let needed: u64 = characters
        .iter()
        .map(|count| (wire.time(*count) + LATENCY).0)
        .sum();
    let rest = wire.time(2).0 * (count as u64 - 1);
    each_us.sort_unstable();
    Ok(Row {
        asked: count,
        characters: characters.iter().sum::<usize>() as f64 / characters.len() as f64,
        share: needed as f64 / elapsed as f64,
        bound: needed as f64 / (needed + rest) as f64,
        peer: needed as f64 / peer.as_micros() as f64,
        each_us,
    })
}

/// Returns the number of characters in request and reply, their CRs included.
fn characters(answer: &Answer) -> usize {
    written(&answer.command).len() + answer.raw.len() + 1
}

fn written(command: &Command) -> Vec<u8> {
    let mut request = Vec::new();
    command.encode(false, &mut request);
    request
}

/// Sends `commands` in turn until `count` have been answered; the next request is always waiting.
async fn exchange_all(path: &str, baud: u32, commands: &[Command], count: usize) -> Vec<Answer> {
    let mut settings = LineSettings::new("bench", baud);
    settings.checksum = false;
    let (ask, to_line) = mpsc::channel(1);
    let (from_line, mut answers) = mpsc::channel(1);
    tokio::spawn(bus::run_reopening(
        bus::serial_port(path.to_owned(), baud),
        settings,
        Pace::real(),
        to_line,
        from_line,
    ));
    let turns: Vec<Command> = commands.iter().copied().cycle().take(count).collect();
    tokio::spawn(async move {
        for (ticket, command) in (0..).zip(turns) {
            let request = Request {
                ticket,
                command,
                tries: 1,
            };
            if ask.send(request).await.is_err() {
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
