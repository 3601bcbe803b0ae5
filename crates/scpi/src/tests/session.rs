//! Tests of the state machine alone: its moves against scripted ends.

use crate::{Echo, Failure, Form, LinkSettings, Move, Program, Raw, Reply, Session, Step};
use units::Span;

const IDENTITY: &str = "MAKER,MODEL,1,1";

/// An instrument behind the state machine, without stream and clock.
struct Bench {
    session: Session,
    ese: String,
    events: &'static str,
    errors: Vec<&'static str>,
    identity: &'static str,
    /// Reply to every other query.
    value: Result<&'static str, Failure>,
    sent: Vec<String>,
    /// False for an instrument that ignores `*ESE`.
    ese_works: bool,
}

impl Bench {
    fn new() -> Self {
        Self::with_echo(Echo::Ese)
    }

    fn with_echo(echo: Echo) -> Self {
        let set_up = Program {
            steps: vec![Step::send("SETUP")],
        };
        let settings = LinkSettings {
            set_up,
            echo,
            ..LinkSettings::default()
        };
        Self {
            session: Session::new(settings, 7),
            ese: "0".to_owned(),
            events: "128",
            errors: Vec::new(),
            identity: IDENTITY,
            value: Ok("1.5"),
            sent: Vec::new(),
            ese_works: true,
        }
    }

    fn run(&mut self) -> Result<Vec<Reply>, Failure> {
        let program = Program {
            steps: vec![Step::ask("READ?", Form::Number)],
        };
        let next = self.session.start(program);
        self.carry_out(next)
    }

    fn carry_out(&mut self, mut next: Move) -> Result<Vec<Reply>, Failure> {
        for _ in 0..1000 {
            let outcome = match next {
                Move::Done(result) => return result,
                Move::Open { .. } | Move::Drain { .. } => Ok(None),
                Move::Send { bytes, .. } => {
                    self.write(&bytes);
                    Ok(None)
                }
                // Only the next reply is wanted, and each query has one.
                Move::Ask(question) if question.bytes.is_empty() => Err(Failure::Timeout {
                    command: question.command,
                    limit: question.limit,
                }),
                Move::Ask(question) => {
                    self.write(&question.bytes);
                    self.reply(&question.command).map(Some)
                }
            };
            next = self.session.next(outcome);
        }
        panic!("the moves of a program are not bounded")
    }

    fn write(&mut self, bytes: &[u8]) {
        let text = String::from_utf8_lossy(bytes).trim().to_owned();
        if let Some(number) = text.strip_prefix("*ESE ")
            && self.ese_works
        {
            self.ese = number.to_owned();
        }
        self.sent.push(text);
    }

    fn reply(&mut self, command: &str) -> Result<Raw, Failure> {
        let text = match command {
            "*ESE?" => self.ese.clone(),
            "*ESR?" => std::mem::replace(&mut self.events, "0").to_owned(),
            "*IDN?" => self.identity.to_owned(),
            "SYST:ERR?" => self.errors.pop().unwrap_or("0,\"No error\"").to_owned(),
            _ => self.value.clone()?.to_owned(),
        };
        Ok(Raw::Line(text.into_bytes()))
    }

    fn set_ups(&self) -> usize {
        self.sent.iter().filter(|it| *it == "SETUP").count()
    }
}

fn late() -> Failure {
    Failure::Timeout {
        command: "READ?".to_owned(),
        limit: Span::ms(1),
    }
}

#[test]
fn the_first_program_sets_up_and_later_ones_do_not() {
    let mut bench = Bench::new();
    assert_eq!(bench.run(), Ok(vec![Reply::Number(1.5)]));
    assert_eq!(bench.session.identity(), Some(IDENTITY));
    assert_eq!(bench.run(), Ok(vec![Reply::Number(1.5)]));
    assert_eq!((bench.set_ups(), bench.session.generation()), (1, 1));
}

#[test]
fn a_time_out_leaves_doubt_and_returns_at_once() {
    let mut bench = Bench::new();
    bench.run().unwrap();
    bench.value = Err(late());
    assert_eq!(bench.run(), Err(late()));
    assert!(!bench.session.is_in_step());
    assert_eq!(
        bench.set_ups(),
        1,
        "the resynchronisation waits for the next program"
    );
    bench.value = Ok("2");
    assert_eq!(bench.run(), Ok(vec![Reply::Number(2.0)]));
    assert_eq!(bench.set_ups(), 2);
}

#[test]
fn a_failure_outside_a_program_leaves_doubt() {
    let mut bench = Bench::new();
    bench.run().unwrap();
    bench.session.doubt();
    bench.run().unwrap();
    assert_eq!(bench.set_ups(), 2);
}

#[test]
fn an_unknown_query_is_named_by_the_instrument() {
    let mut bench = Bench::new();
    bench.run().unwrap();
    let queue = vec!["-420,\"Query UNTERMINATED\"", "-113,\"Undefined header\""];
    (bench.value, bench.errors) = (Err(late()), queue);
    let (code, text) = (-113, "Undefined header".to_owned());
    assert_eq!(bench.run(), Err(Failure::Instrument { code, text }));
    bench.value = Ok("1.5");
    let next = bench.run();
    assert_eq!(next, Ok(vec![Reply::Number(1.5)]), "no error is left");
}

#[test]
fn the_safe_program_needs_no_set_up() {
    let mut bench = Bench::new();
    bench.errors = vec!["-222,\"Data out of range\""];
    assert_eq!(bench.run().unwrap_err().code(), "instrument");
    let off = Program {
        steps: vec![Step::send("OFF")],
    };
    let next = bench.session.start_safe(off);
    assert_eq!(bench.carry_out(next), Ok(Vec::new()));
    assert!(bench.sent.contains(&"OFF".to_owned()) && bench.set_ups() == 1);
    bench.run().unwrap();
    assert_eq!(bench.set_ups(), 2, "the next program sets up");
}

#[test]
fn an_error_of_the_instrument_withholds_the_values() {
    let mut bench = Bench::new();
    bench.run().unwrap();
    bench.errors = vec!["-222,\"Data out of range\""];
    let (code, text) = (-222, "Data out of range".to_owned());
    assert_eq!(bench.run(), Err(Failure::Instrument { code, text }));
    assert!(bench.session.is_in_step());
}

#[test]
fn a_queue_that_stays_full_is_left() {
    let mut bench = Bench::new();
    bench.run().unwrap();
    bench.errors = vec!["-222,\"Data out of range\""; 100];
    assert_eq!(bench.run(), Err(Failure::QueueOverflow));
    bench.errors = vec!["-350,\"Queue overflow\""];
    assert_eq!(bench.run().unwrap_err(), Failure::QueueOverflow);
}

#[test]
fn a_loss_of_power_is_found_at_the_end() {
    let mut bench = Bench::new();
    bench.run().unwrap();
    (bench.ese, bench.events) = ("0".to_owned(), "128");
    assert_eq!(bench.run(), Err(Failure::PowerCycled));
    assert_eq!(bench.run(), Ok(vec![Reply::Number(1.5)]), "reported once");
    assert_eq!(bench.set_ups(), 2);
}

#[test]
fn a_loss_of_power_during_doubt_is_reported_by_the_next() {
    let mut bench = Bench::new();
    bench.run().unwrap();
    bench.value = Err(late());
    bench.run().unwrap_err();
    (bench.value, bench.events) = (Ok("1"), "128");
    assert_eq!(bench.run(), Err(Failure::PowerCycled));
    assert_eq!(bench.run(), Ok(vec![Reply::Number(1.0)]));
}

#[test]
fn the_number_of_another_program_proves_nothing() {
    let mut bench = Bench::new();
    bench.run().unwrap();
    bench.ese = "128".to_owned();
    assert_eq!(bench.run().unwrap_err().code(), "out_of_step");
}

#[test]
fn another_identity_is_no_proof() {
    let mut bench = Bench::with_echo(Echo::Identity);
    bench.run().unwrap();
    assert_eq!(bench.run(), Ok(vec![Reply::Number(1.5)]));
    bench.identity = "MAKER,MODEL,2,1";
    assert_eq!(bench.run().unwrap_err().code(), "wrong_identity");
}

#[test]
fn codes_of_failures_are_unique() {
    let mut codes = Failure::CODES.to_vec();
    codes.sort_unstable();
    codes.dedup();
    assert_eq!(codes.len(), Failure::CODES.len());
}

#[test]
fn a_reply_without_echo_or_identity_is_no_silence() {
    for (command, identity, ese_works) in
        [("*IDN?", "ACME Counter", true), ("*ESE?", IDENTITY, false)]
    {
        let mut bench = Bench::new();
        (bench.identity, bench.ese_works) = (identity, ese_works);
        let Err(Failure::Down { last, .. }) = bench.run() else {
            panic!("in step without {command}");
        };
        let command = command.to_owned();
        assert_eq!(*last, Failure::OutOfStep { command });
    }
}
