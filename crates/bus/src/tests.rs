//! Tests: a line talks to scripted modules in virtual time.

#![allow(clippy::unwrap_used)]

use super::*;
use dcon::{Address, Bits, Command, Common, Counter, Digital, OutputWord, Reply, ReplyError, UpTo};
use std::future::Future;
use tokio::io::{AsyncReadExt, AsyncWriteExt, DuplexStream, duplex};
use tokio::sync::mpsc;
use units::{RigTime, Span};

mod instruments;
mod late_host;
mod ports;
mod probation;
mod records;
mod replay;
mod steps;

/// One piece of a module's reply: its delay after the request, microseconds, and its bytes.
type Say = (u64, &'static [u8]);

/// Reply with the count 30 (hexadecimal 1E) and its checksum; `NINE` is the reply with the count 9.
const THIRTY: &[u8] = b">0000001ED4\r";
const NINE: &[u8] = b">00000009C7\r";

fn count() -> Command {
    Counter::Read(UpTo::new(0).unwrap()).to(Address(3))
}

fn write() -> Command {
    Digital::Write(OutputWord::sixteen(0x1234)).to(Address(4))
}

fn settings() -> LineSettings {
    LineSettings::new("measure", 115_200)
}

/// Runs `test` in virtual time on a current-thread runtime.
fn in_virtual_time<F: Future>(test: F) -> F::Output {
    virtual_time::block_on(test).unwrap()
}

/// Answers the n-th request with the n-th entry of `script`; leaves later requests unanswered. Answers a request for
/// the name after all earlier bytes; such a request has no entry in `script` and is not returned.
async fn modules(mut stream: DuplexStream, pace: Pace, script: Vec<Vec<Say>>) -> Vec<String> {
    let mut sent = Vec::new();
    let mut script = script.into_iter();
    while let Some(request) = next_request(&mut stream).await {
        let heard_at = pace.now();
        if let Some(name) = named(&request) {
            pace.sleep_until(heard_at + Span(2_000)).await;
            let _ = stream.write_all(name.as_bytes()).await;
            continue;
        }
        sent.push(request);
        for (after, bytes) in script.next().unwrap_or_default() {
            pace.sleep_until(heard_at + Span(after)).await;
            let _ = stream.write_all(bytes).await;
        }
    }
    sent
}

/// Returns the reply to a request for configuration, firmware version or name; `None` for any other request.
fn named(request: &str) -> Option<String> {
    let address = request.strip_prefix('$')?.get(..2)?;
    let told = match (request.len(), request.as_bytes().get(3)?) {
        (6, b'2') => "400640",
        (6, b'F') => "A2.0",
        (6, b'M') => "7080",
        _ => return None,
    };
    let text = format!("!{address}{told}");
    let sum = dcon::checksum(text.as_bytes());
    Some(format!("{text}{sum:02X}\r"))
}

async fn next_request(stream: &mut DuplexStream) -> Option<String> {
    let mut request = Vec::new();
    loop {
        match stream.read_u8().await {
            Ok(b'\r') => return String::from_utf8(request).ok(),
            Ok(byte) => request.push(byte),
            Err(_) => return None,
        }
    }
}

/// Sends `requests` one after the other; returns the answers and the requests that the modules received.
async fn played(
    settings: LineSettings,
    script: Vec<Vec<Say>>,
    requests: &[(Command, u8)],
) -> (Vec<Answer>, Vec<String>) {
    let pace = Pace::virtual_time();
    let (ours, theirs) = duplex(4096);
    let (ask, to_line) = mpsc::channel(1);
    let (from_line, mut answers) = mpsc::channel(1);
    let line = run(ours, settings, pace, to_line, from_line);
    let client = async {
        let mut got = Vec::new();
        for (ticket, (command, tries)) in requests.iter().enumerate() {
            ask.send(Request {
                ticket: ticket as u64,
                command: *command,
                tries: *tries,
            })
            .await
            .unwrap();
            got.push(answers.recv().await.unwrap());
        }
        drop(ask);
        got
    };
    let (sent, (), got) = tokio::join!(modules(theirs, pace, script), line, client);
    (got, sent)
}

#[test]
fn a_reply_in_time_carries_its_text_and_times() {
    let (got, sent) = in_virtual_time(played(
        settings(),
        vec![vec![(3_000, THIRTY)]],
        &[(count(), 1)],
    ));
    assert_eq!(sent, ["#030B6"]);
    assert_eq!(got[0].outcome, Ok(Reply::Count(30)));
    assert_eq!(got[0].raw, ">0000001ED4");
    assert_eq!(
        (got[0].requested_at, got[0].answered_at),
        (RigTime(0), RigTime(3_000))
    );
    assert_eq!((got[0].ticket, got[0].tries_used), (0, 1));
}

#[test]
fn a_reply_may_come_in_pieces() {
    let pieces: Vec<Say> = vec![
        (1_000, &THIRTY[..3]),
        (2_000, &THIRTY[3..8]),
        (9_000, &THIRTY[8..]),
    ];
    let (got, _) = in_virtual_time(played(settings(), vec![pieces], &[(count(), 1)]));
    assert_eq!(got[0].outcome, Ok(Reply::Count(30)));
}

#[test]
fn a_late_reply_never_counts_for_the_next_request() {
    let limit = settings().time_out(&count()).0;
    let grace = settings().silence(&count()).0;
    // A reply at each hundredth of the time from the deadline to the end of the required silence.
    for late in (0..100).map(|part| limit + 1 + part * (grace - 2) / 100) {
        let script = vec![vec![(late, THIRTY)], vec![(2_000, NINE)]];
        let (got, sent) =
            in_virtual_time(played(settings(), script, &[(count(), 1), (count(), 1)]));
        assert!(
            matches!(
                got[0].outcome,
                Err(LineError {
                    failure: Failure::TimeOut(_),
                    ..
                })
            ),
            "{late}: {:?}",
            got[0].outcome
        );
        assert_eq!(got[1].outcome, Ok(Reply::Count(9)), "late by {late}");
        assert_eq!(sent.len(), 2);
    }
}

#[test]
fn a_silent_module_times_out_after_every_allowed_try() {
    let (got, sent) = in_virtual_time(played(settings(), vec![], &[(count(), 3)]));
    assert_eq!(got[0].tries_used, 3);
    assert_eq!(sent.len(), 3);
    let limit = settings().time_out(&count());
    assert_eq!(got[0].answered_at.since(got[0].requested_at), limit);
    let text = got[0].outcome.as_ref().unwrap_err().to_string();
    assert!(
        text.starts_with("line measure, module 03, read counter 0: ")
            && text.contains("no whole reply within"),
        "{text}"
    );
}

#[test]
fn a_damaged_reply_to_a_read_is_requested_again() {
    let damaged = vec![(2_000, b">0000001FD4\r" as &[u8])];
    let (got, sent) = in_virtual_time(played(
        settings(),
        vec![damaged, vec![(2_000, THIRTY)], vec![(2_000, THIRTY)]],
        &[(count(), 2)],
    ));
    assert_eq!(
        (got[0].outcome.clone(), got[0].tries_used, sent.len()),
        (Ok(Reply::Count(30)), 2, 3)
    );
}

#[test]
fn a_write_is_sent_only_once() {
    for say in [
        vec![],
        vec![(2_000, b">3F\r" as &[u8])],
        vec![(2_000, b">\x003E\r")],
    ] {
        let (got, sent) = in_virtual_time(played(settings(), vec![say], &[(write(), 5)]));
        assert!(got[0].outcome.is_err());
        assert_eq!((got[0].tries_used, sent.len()), (1, 1));
    }
}

#[test]
fn a_refusal_causes_neither_a_repetition_nor_a_silence() {
    let script = vec![
        vec![(2_000, b"?03A3\r" as &[u8])],
        vec![(2_000, b"?03A2\r")],
        vec![(2_000, NINE)],
        vec![(2_000, NINE)],
    ];
    let (got, sent) = in_virtual_time(played(
        settings(),
        script,
        &[(count(), 1), (count(), 5), (count(), 1)],
    ));
    assert!(matches!(
        got[0].outcome,
        Err(LineError {
            failure: Failure::Reply(ReplyError::ChecksumWrong { .. }),
            ..
        })
    ));
    assert!(
        matches!(
            got[1].outcome,
            Err(LineError {
                failure: Failure::Reply(ReplyError::Refused),
                ..
            })
        ),
        "{:?}",
        got[1]
    );
    assert_eq!(got[1].tries_used, 1);
    assert_eq!(
        got[2].requested_at,
        got[1].answered_at + settings().turnaround()
    );
    // After the damage the line reads the count twice.
    assert_eq!(sent.len(), 4);
}

#[test]
fn replies_of_two_modules_at_one_address_are_rejected() {
    let turnaround = settings().turnaround().0;
    let at_once: Vec<Say> = vec![(2_000, b">0000001ED4\r>00000009C7\r")];
    let soon: Vec<Say> = vec![(2_000, THIRTY), (2_000 + turnaround - 1, NINE)];
    for say in [at_once, soon] {
        let (got, _) = in_virtual_time(played(
            settings(),
            vec![say, vec![(2_000, NINE)], vec![(2_000, NINE)]],
            &[(count(), 1), (count(), 1)],
        ));
        assert!(
            matches!(
                got[0].outcome,
                Err(LineError {
                    failure: Failure::SecondReply,
                    ..
                })
            ),
            "{:?}",
            got[0].outcome
        );
        assert_eq!(got[1].outcome, Ok(Reply::Count(9)));
    }
}

#[test]
fn an_echo_is_reported_as_an_echo() {
    let (got, _) = in_virtual_time(played(
        settings(),
        vec![vec![(0, b"#030B6\r")]],
        &[(count(), 1)],
    ));
    assert!(
        matches!(
            got[0].outcome,
            Err(LineError {
                failure: Failure::Echo,
                ..
            })
        ),
        "{:?}",
        got[0].outcome
    );
}

#[test]
fn more_characters_than_a_frame_has_are_dropped() {
    let noise: Vec<Say> = vec![(2_000, &[b'>'; 100])];
    let (got, _) = in_virtual_time(played(
        settings(),
        vec![noise, vec![(2_000, NINE)], vec![(2_000, NINE)]],
        &[(count(), 1), (count(), 1)],
    ));
    assert!(matches!(
        got[0].outcome,
        Err(LineError {
            failure: Failure::Reply(ReplyError::TooLong { .. }),
            ..
        })
    ));
    assert_eq!(got[1].outcome, Ok(Reply::Count(9)));
}

#[test]
fn a_line_that_never_falls_silent_gets_no_request() {
    let babble: Vec<Say> = (1..60).map(|turn| (turn * 5_000, b"U" as &[u8])).collect();
    let mut script = vec![babble];
    script.extend(vec![vec![(2_000, NINE)]; 9]);
    let (got, sent) = in_virtual_time(played(settings(), script, &[(count(), 1); 10]));
    let longest = longest_transaction(&settings(), &[count()]);
    let unsent = got
        .iter()
        .filter(|a| {
            matches!(
                a.outcome,
                Err(LineError {
                    failure: Failure::NeverSilent,
                    ..
                })
            )
        })
        .count();
    // After the stray bytes the line reads each count that it does request twice.
    assert!(unsent > 0 && sent.len() < 2 * (10 - unsent), "{sent:?}");
    for pair in got.windows(2) {
        assert!(
            pair[1].requested_at.since(pair[0].requested_at) <= longest,
            "{:?}",
            pair[1]
        );
    }
    assert!(
        got.iter()
            .any(|answer| answer.outcome == Ok(Reply::Count(9))),
        "{got:?}"
    );
}

#[test]
fn a_broadcast_takes_its_wire_time_and_the_turnaround() {
    let (got, sent) = in_virtual_time(played(
        settings(),
        vec![],
        &[(Command::HostOk, 1), (Command::HostOk, 1)],
    ));
    assert_eq!(got[0].outcome, Ok(Reply::Sent));
    assert_eq!(sent, ["~**D2", "~**D2"]);
    let each = settings().wire().time(6) + settings().turnaround();
    assert_eq!(got[1].requested_at.since(got[0].requested_at), each);
}

#[test]
fn requests_are_answered_in_order_one_turnaround_apart() {
    let script = vec![vec![(2_500, THIRTY)]; 50];
    let (got, _) = in_virtual_time(played(settings(), script, &[(count(), 1); 50]));
    for pair in got.windows(2) {
        assert_eq!(pair[1].ticket, pair[0].ticket + 1);
        assert_eq!(
            pair[1].requested_at,
            pair[0].answered_at + settings().turnaround()
        );
    }
}

#[test]
fn a_line_without_checksum_sends_plain_frames() {
    let mut settings = settings();
    settings.checksum = false;
    let read = Digital::ReadAll.to(Address(4));
    let (got, sent) = in_virtual_time(played(
        settings,
        vec![vec![(2_000, b"!BEDE00\r")]],
        &[(read, 1)],
    ));
    assert_eq!(sent, ["$046"]);
    assert_eq!(
        got[0].outcome,
        Ok(Reply::Bits(Bits {
            first: 0xBE,
            second: 0xDE
        }))
    );
}
