//! Tests: a recorded trace is replayed to the line; the same bytes at the same intervals give the same outcomes.

use super::*;
use dcon::interpret;

/// Plays the modules in `recorded`: after each request, sends the bytes that were recorded after it, with the same
/// delay.
async fn play(mut stream: DuplexStream, pace: Pace, recorded: Recorded) -> (bool, DuplexStream) {
    let mut entries = recorded.entries.into_iter().peekable();
    let mut same = true;
    while let Some(asked) = entries.next() {
        let Some(request) = next_request(&mut stream).await else {
            return (false, stream);
        };
        same &= asked.direction == Direction::Sent
            && asked.bytes() == format!("{request}\r").as_bytes();
        let heard_at = pace.now();
        while let Some(said) = entries.next_if(|entry| entry.direction != Direction::Sent) {
            pace.sleep_until(heard_at + said.at.since(asked.at)).await;
            let _ = stream.write_all(said.bytes()).await;
        }
    }
    // The stream is returned so that the port stays open until the last outcome.
    (same, stream)
}

/// Many kinds of trouble in one trace: good replies, silence with a late reply, damage, noise, a refusal.
fn troubled() -> (Vec<(Command, u8)>, Vec<Vec<Say>>) {
    let asks = vec![
        (count(), 1),
        (count(), 2),
        (write(), 1),
        (count(), 3),
        (count(), 1),
    ];
    let script: Vec<Vec<Say>> = vec![
        vec![(2_000, THIRTY)],
        vec![(40_000, THIRTY)],
        vec![(2_000, NINE)],
        vec![(2_500, b">3E\r")],
        vec![(2_000, b">0000001FD4\r")],
        vec![(1_000, b"\x00\xFFU"), (2_000, NINE)],
        vec![(2_000, NINE)],
        vec![(2_000, b"?03A2\r")],
    ];
    (asks, script)
}

fn conclusions(answers: &[Answer]) -> Vec<(Result<Reply, LineError>, String, u8)> {
    let told = |answer: &Answer| {
        (
            answer.outcome.clone(),
            answer.raw.clone(),
            answer.tries_used,
        )
    };
    answers.iter().map(told).collect()
}

#[test]
fn a_replayed_trace_leads_to_the_same_conclusions() {
    let (asks, script) = troubled();
    let first = settings();
    let log = first.log.clone();
    let (got, _) = in_virtual_time(played(first, script, &asks));
    let text = Recorded::of(&log.trace(), "measure", 115_200, true).text();
    let recorded = Recorded::parse(&text).unwrap();
    let again = settings();
    let second = again.log.clone();
    let (same, replayed) = in_virtual_time(async {
        let pace = Pace::virtual_time();
        let (ours, theirs) = duplex(4096);
        let (ask, to_line) = mpsc::channel(1);
        let (from_line, mut answers) = mpsc::channel(1);
        let line = run(ours, again, pace, to_line, from_line);
        let client = async {
            let mut got = Vec::new();
            for (command, tries) in asks {
                let ticket = got.len() as u64;
                ask.send(Request {
                    ticket,
                    command,
                    tries,
                })
                .await
                .unwrap();
                got.push(answers.recv().await.unwrap());
            }
            drop(ask);
            got
        };
        let ((same, _open), (), got) = tokio::join!(play(theirs, pace, recorded), line, client);
        (same, got)
    });
    assert!(same, "other requests than recorded:\n{text}");
    assert_eq!(conclusions(&replayed), conclusions(&got));
    assert_eq!(second.fingerprint(), log.fingerprint());
    assert!(got.iter().any(|answer| answer.outcome.is_err()), "{text}");
}

#[test]
fn a_trace_as_text_parses_back_byte_for_byte() {
    let (asks, script) = troubled();
    let settings = settings();
    let log = settings.log.clone();
    in_virtual_time(played(settings, script, &asks));
    let recorded = Recorded::of(&log.trace(), "measure", 115_200, true);
    let back = Recorded::parse(&recorded.text()).unwrap();
    assert_eq!(
        (back.baud, back.checksum, &*back.line),
        (115_200, true, "measure")
    );
    assert_eq!(back.entries, recorded.entries);
    let said = interpret(
        back.entries[0].bytes(),
        back.entries[1].bytes(),
        back.checksum,
        None,
    );
    assert!(said.contains(&(count(), Ok(Reply::Count(30)))), "{said:?}");
}

#[test]
fn a_text_that_is_no_trace_is_refused_with_its_row() {
    for (text, row) in [
        ("", 1),
        ("# line motion fast checksum\n", 1),
        ("# line motion 9600 plain\n12 > @11\\r\n13 = >\\r\n", 3),
        ("# line motion 9600 plain\nx > @11\\r\n", 2),
        ("# line motion 9600 plain\n12 > \\q\n", 2),
    ] {
        assert_eq!(Recorded::parse(text).unwrap_err().row, row, "{text}");
    }
}
