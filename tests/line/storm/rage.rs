//! A storm on one line: random transactions under random faults, and a judge that reads from the fingerprint of each
//! value its module, channel and time.
//!
//! The line task runs over an in-process stream in virtual time. The rules:
//!
//! - a reading must come from the module and channel of the request (else it is *foreign*), and have been true
//!   between request and answer (else *stale*; analog inputs: within the age of a free-running conversion);
//! - an accepted write must have been carried out (else *hollow*);
//! - a failure must name line, address and command (else *nameless*);
//! - every request must be answered within [`ANSWER_TIMEOUT_US`] of rig time (else it *hangs*).

use bus::{Answer, Failure, LineError, LineSettings, Pace, Request};
use dcon::{
    Address, AnalogIn, AnalogOut, Channel, Command, Common, Counter, DataFormat, Digital,
    InputForm, Level, OutputForm, OutputWord, Reply, ReplyError, TypeCode, UpTo, Value,
};
use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use rigsim::fingerprint::{self, FingerprintLine};
use rigsim::wire;
use std::collections::BTreeMap;
use std::time::Instant;
use tokio::sync::mpsc;

/// Every fault of the line, each at 1 %: lost, late within and beyond the time-out, damaged, doubled, reset, unplugged.
pub const EVERY_FAULT: [&str; 13] = [
    "drop=0.01",
    "deaf=0.01",
    "truncate=0.01",
    "late=0.01/20",
    "late=0.01/200",
    "flip=0.01",
    "noise=0.01",
    "echo=0.01",
    "clash=0.01",
    "garble=0.01",
    "reset=0.01",
    "watchdog_trip=0.01",
    "port_lost=0.01/20",
];

/// Silence of a line after a time-out, ms. No host can distinguish a reply later than time-out and silence from the
/// next one. The two late faults together make 220 ms.
const GRACE_MS: u64 = 200;

/// Longest time until an answer, microseconds of rig time: two tries, each with time-out, noisy silence and a lost port.
const ANSWER_TIMEOUT_US: u64 = 5_000_000;

/// Age of a reading of a free-running converter, microseconds: eight windows of 1/60 s, three of 1/15 s, two steps.
const CONVERSION_US: u64 = 250_000;

/// Most examples of each kind of broken rule.
const EXAMPLES: usize = 5;

/// Result of a storm.
#[derive(Debug, Default)]
pub struct Weather {
    /// Answered requests.
    pub transactions: u64,
    /// Requests whose reply was accepted.
    pub believed: u64,
    /// Failures by kind.
    pub failures: BTreeMap<&'static str, u64>,
    /// Readings of another module or channel.
    pub foreign: u64,
    /// Readings taken before their request.
    pub stale: u64,
    /// Writes accepted and not carried out.
    pub hollow: u64,
    /// Failures that do not name line, address and command.
    pub nameless: u64,
    /// Requests that were never answered.
    pub hangs: u64,
    /// Examples of broken rules.
    pub examples: Vec<String>,
    /// Rig time, seconds.
    pub rig_s: f64,
    /// Wall time, seconds.
    pub wall_s: f64,
}

impl Weather {
    /// Returns true when no rule was broken.
    pub fn is_honest(&self) -> bool {
        self.foreign + self.stale + self.hollow + self.nameless + self.hangs == 0
    }

    fn lie(&mut self, kind: fn(&mut Self) -> &mut u64, what: &str, answer: &Answer) {
        *kind(self) += 1;
        if self.examples.len() < EXAMPLES {
            self.examples.push(format!("{what}: {answer:?}"));
        }
    }
}

/// Runs a storm of `transactions` transactions.
pub fn rage(seed: u64, transactions: u64, faults: &[&str]) -> Weather {
    virtual_time::block_on(storm(seed, transactions, faults)).expect("a runtime")
}

/// As [`rage`], on an existing runtime of virtual time.
pub async fn storm(seed: u64, transactions: u64, faults: &[&str]) -> Weather {
    let line = FingerprintLine::build(seed, 115_200, faults).expect("known faults");
    let pace = Pace::virtual_time();
    let (_, plug) = wire::plugs(&line.rig).remove(0);
    let (ask, asked) = mpsc::channel(1);
    let (answer, mut answers) = mpsc::channel(1);
    let mut settings = LineSettings::new(fingerprint::LINE, 115_200);
    settings.late_reply_ms = GRACE_MS;
    tokio::spawn(bus::run_reopening(
        bus::from_streams(move || plug.open()),
        settings,
        pace,
        asked,
        answer,
    ));
    let mut host = Host {
        random: SplitMix64::seed_from_u64(seed),
        written: 0,
        next: None,
    };
    let began = Instant::now();
    let mut weather = Weather::default();
    for ticket in 0..transactions {
        let command = host.command();
        let request = Request {
            ticket,
            command,
            tries: 2,
        };
        ask.send(request).await.expect("the line listens");
        let Some(answer) = virtual_time::within(ANSWER_TIMEOUT_US, answers.recv()).await else {
            weather.hangs += 1;
            break;
        };
        let answer = answer.expect("the line answers");
        host.heed(&answer);
        judge(&answer, ticket, &line, &mut weather);
    }
    weather.rig_s = pace.now().0 as f64 / 1e6;
    weather.wall_s = began.elapsed().as_secs_f64();
    weather
}

/// Chooses requests.
struct Host {
    random: SplitMix64,
    written: u16,
    next: Option<Command>,
}

impl Host {
    /// Returns a number from 0 to below `most`.
    fn below(&mut self, most: u8) -> u8 {
        ((self.random.next_u64() >> 32) % u64::from(most)) as u8
    }

    fn command(&mut self) -> Command {
        if let Some(next) = self.next.take() {
            return next;
        }
        match self.below(20) {
            0..=4 => self.analog(),
            5 => AnalogIn::ReadAll(form(1)).to(Address(1 + self.below(2))),
            6..=8 => {
                let n = UpTo::new(self.below(2)).expect("0 or 1");
                Counter::Read(n).to(Address(4 + self.below(2)))
            }
            9..=11 => Digital::ReadPort.to(Address(6 + self.below(4))),
            12 => Digital::ReadAll.to(Address(6 + self.below(4))),
            13..=15 => self.digital_write(),
            16 | 17 => self.level_write(),
            18 => AnalogOut::ReadLast {
                channel: None,
                form: OutputForm::Hex16,
            }
            .to(Address(0x0A + self.below(2))),
            _ => match self.below(3) {
                0 => Command::HostOk,
                1 => Common::ReadResetStatus.to(Address(6 + self.below(4))),
                _ => Common::ReadConfig.to(Address(1 + self.below(11))),
            },
        }
    }

    fn analog(&mut self) -> Command {
        let address = 1 + self.below(3);
        let channel = self.below(if address == 3 { 3 } else { 8 });
        AnalogIn::ReadOne {
            channel: Channel::new(channel).expect("a channel"),
            form: form(address),
        }
        .to(Address(address))
    }

    /// Returns a new output word with the mark of its module.
    fn word(&mut self, address: u8) -> u16 {
        self.written = self.written % 0xFFF + 1;
        fingerprint::marked(address, self.written)
    }

    fn digital_write(&mut self) -> Command {
        let address = 8 + self.below(2);
        let word = self.word(address);
        Digital::Write(OutputWord::sixteen(word)).to(Address(address))
    }

    fn level_write(&mut self) -> Command {
        let address = 0x0A + self.below(2);
        let word = self.word(address);
        AnalogOut::Write {
            channel: None,
            level: Level::from_steps(OutputForm::Hex16, i32::from(word)).expect("16 bits"),
        }
        .to(Address(address))
    }

    /// Clears the tripped watchdog of a module.
    fn heed(&mut self, answer: &Answer) {
        if let (
            Err(LineError {
                failure: Failure::Reply(ReplyError::Ignored),
                ..
            }),
            Some(address),
        ) = (&answer.outcome, answer.command.address())
        {
            self.next = Some(Common::ClearWatchdogStatus.to(address));
        }
    }
}

fn form(address: u8) -> InputForm {
    if address == 3 {
        InputForm::three(DataFormat::Hex, TypeCode(0x20))
    } else {
        InputForm::eight(DataFormat::Hex, TypeCode(0x08))
    }
}

fn judge(answer: &Answer, ticket: u64, line: &FingerprintLine, weather: &mut Weather) {
    weather.transactions += 1;
    assert_eq!(answer.ticket, ticket, "answers come in order");
    match &answer.outcome {
        Err(error) => {
            *weather.failures.entry(kind(error)).or_default() += 1;
            if !names_itself(error, &answer.command) {
                weather.lie(|it| &mut it.nameless, "nameless", answer);
            }
        }
        Ok(reply) => {
            weather.believed += 1;
            match found(answer, reply, line) {
                Found::True => {}
                Found::Foreign => weather.lie(|it| &mut it.foreign, "foreign", answer),
                Found::Stale => weather.lie(|it| &mut it.stale, "stale", answer),
                Found::Hollow => weather.lie(|it| &mut it.hollow, "hollow", answer),
            }
        }
    }
}

fn kind(error: &LineError) -> &'static str {
    match &error.failure {
        Failure::TimeOut(_) => "no whole reply in time",
        Failure::Reply(ReplyError::Ignored) => "ignored: watchdog tripped",
        Failure::Reply(ReplyError::Refused) => "refused",
        Failure::Reply(_) => "damaged reply",
        Failure::Echo => "echo",
        Failure::SecondReply => "more behind the reply",
        Failure::NeverSilent => "line never silent",
        Failure::PortLost(_) => "port lost",
        Failure::OutOfStep => "reply of unknown origin",
        Failure::Contradicted => "another value at the second read",
    }
}

fn names_itself(error: &LineError, command: &Command) -> bool {
    let message = error.message();
    let names = |name, value: &str| message.args().get(name) == Some(value);
    let address = command
        .address()
        .map_or("**".to_owned(), |it| it.to_string());
    // A command that writes a setting reads it first, and the reading may fail.
    let mut asked = [Some(*command), command.setting()].into_iter().flatten();
    names("line", fingerprint::LINE)
        && names("address", &address)
        && asked.any(|it| names("request", it.describe().code))
}

enum Found {
    True,
    Foreign,
    Stale,
    Hollow,
}

fn found(answer: &Answer, reply: &Reply, line: &FingerprintLine) -> Found {
    let Some(Address(address)) = answer.command.address() else {
        return Found::True;
    };
    match (&answer.command, reply) {
        (Command::AnalogIn(_, AnalogIn::ReadOne { channel, .. }), Reply::Reading(reading)) => {
            analog(answer, address, channel.get(), reading.value)
        }
        (Command::AnalogIn(_, AnalogIn::ReadAll(_)), Reply::Readings(readings)) => readings
            .iter()
            .enumerate()
            .map(|(channel, reading)| analog(answer, address, channel as u8, reading.value))
            .find(|found| !matches!(found, Found::True))
            .unwrap_or(Found::True),
        (Command::Counter(_, Counter::Read(n)), Reply::Count(count)) => found_unless(
            fingerprint::origin_of_count(*count) == (address, n.get()),
            Found::Foreign,
        ),
        (Command::Digital(..), Reply::Bits(bits)) if address <= 7 => {
            word(answer, address, bits.word())
        }
        (Command::Digital(..), Reply::Bits(bits)) => read_back(answer, address, bits.word(), line),
        (Command::Digital(_, Digital::Write(written)), Reply::Accepted) => found_unless(
            carried(answer, address, written.bits(), line),
            Found::Hollow,
        ),
        (Command::AnalogOut(_, AnalogOut::Write { level, .. }), Reply::Accepted) => found_unless(
            carried(answer, address, level.steps() as u16, line),
            Found::Hollow,
        ),
        (Command::AnalogOut(..), Reply::Level(level)) => {
            read_back(answer, address, level.steps() as u16, line)
        }
        (_, _) => Found::True,
    }
}

fn found_unless(is_true: bool, wrong: Found) -> Found {
    if is_true { Found::True } else { wrong }
}

fn analog(answer: &Answer, address: u8, channel: u8, value: Value) -> Found {
    let Value::Hex(code) = value else {
        return Found::Foreign;
    };
    let code = code.cast_unsigned();
    if fingerprint::origin_of_analog(code) != (address, channel) {
        return Found::Foreign;
    }
    let taken = answer.answered_at.since(answer.requested_at).0;
    let distance = fingerprint::distance_of_analog_us(code, answer.requested_at.0);
    found_unless(distance <= CONVERSION_US + taken, Found::Stale)
}

/// Checks that a word of inputs was taken after the request.
fn word(answer: &Answer, address: u8, word: u16) -> Found {
    if fingerprint::origin_of_word(word) != address {
        return Found::Foreign;
    }
    let taken = answer.answered_at.since(answer.requested_at).0;
    let age = fingerprint::age_of_word_us(word, answer.answered_at.0);
    found_unless(age <= taken + fingerprint::WORD_STEP_US, Found::Stale)
}

/// Checks that a read-back matches the outputs during the request; a restart after the answer does not count.
fn read_back(answer: &Answer, address: u8, word: u16, line: &FingerprintLine) -> Found {
    if fingerprint::origin_of_word(word) != address {
        return Found::Foreign;
    }
    found_unless(carried(answer, address, word, line), Found::Stale)
}

fn carried(answer: &Answer, address: u8, word: u16, line: &FingerprintLine) -> bool {
    line.carried(address, word, answer.requested_at.0, answer.answered_at.0)
}
