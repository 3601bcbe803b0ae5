//! Tests: damage that is seen at an address warns of damage that passes for a reply.

use super::*;
use dcon::{AnalogIn, Channel, DataFormat, InputForm, TypeCode};

/// A count whose last checksum digit is wrong.
const DAMAGED: &[u8] = b">0000001ED5\r";
/// A reading soon after: count 31. `ELSEWHERE` is a reading far from it: count 90 000 000.
const SOON: &[u8] = b">0000001FD5\r";
const ELSEWHERE: &[u8] = b">055D4A80F9\r";

fn say(bytes: &'static [u8]) -> Vec<Say> {
    vec![(2_000, bytes)]
}

fn played_count(script: Vec<Vec<Say>>, requests: &[(Command, u8)]) -> (Vec<Answer>, usize) {
    let (got, sent) = in_virtual_time(played(settings(), script, requests));
    (got, sent.len())
}

#[test]
fn after_a_damaged_reply_an_address_is_read_twice() {
    let script = vec![say(DAMAGED), say(THIRTY), say(THIRTY)];
    let (got, sent) = played_count(script, &[(count(), 1), (count(), 1)]);
    assert!(matches!(
        got[0].outcome,
        Err(LineError {
            failure: Failure::Reply(_),
            ..
        })
    ));
    assert_eq!((got[1].outcome.clone(), sent), (Ok(Reply::Count(30)), 3));
    assert_eq!(got[1].raw, ">0000001ED4");
}

#[test]
fn three_different_answers_to_one_request_are_rejected() {
    let script = vec![
        say(DAMAGED),
        say(ELSEWHERE),
        say(THIRTY),
        say(NINE),
        say(THIRTY),
        say(THIRTY),
    ];
    let (got, sent) = played_count(script, &[(count(), 1), (count(), 1), (count(), 1)]);
    let text = got[1].outcome.as_ref().unwrap_err().to_string();
    assert!(
        text.starts_with("line measure, module 03, read counter 0: ")
            && text.contains("repeated reads disagree"),
        "{text}"
    );
    assert_eq!((got[2].outcome.clone(), sent), (Ok(Reply::Count(30)), 6));
}

#[test]
fn a_switched_input_needs_a_third_answer_that_agrees() {
    let port = Digital::ReadPort.to(Address(3));
    let answers_to = |third| {
        let script = vec![
            say(DAMAGED),
            say(b">3B3F2C\r"),
            say(b">3B7F30\r"),
            say(third),
        ];
        played_count(script, &[(count(), 1), (port, 1)])
    };
    let (got, sent) = answers_to(b">3B7F30\r");
    let bits = Bits {
        first: 0x3B,
        second: 0x7F,
    };
    assert_eq!((got[1].outcome.clone(), sent), (Ok(Reply::Bits(bits)), 4));
    // The time stored is that of the second answer, the first one to show the new input.
    assert!(got[1].requested_at >= got[0].answered_at + Span(2_000));
    assert!(got[1].answered_at.since(got[1].requested_at) < Span(3_000));
    let (got, _) = answers_to(b">3B3F2C\r");
    assert!(matches!(
        got[1].outcome,
        Err(LineError {
            failure: Failure::Contradicted,
            ..
        })
    ));
}

#[test]
fn a_falling_count_or_frequency_needs_a_third_answer() {
    let frequency = Counter::ReadFrequency(UpTo::new(0).unwrap()).to(Address(3));
    for (command, nine) in [(count(), Reply::Count(9)), (frequency, Reply::Frequency(9))] {
        let script = vec![say(DAMAGED), say(THIRTY), say(NINE), say(NINE)];
        let (got, sent) = played_count(script, &[(count(), 1), (command, 1)]);
        assert_eq!((got[1].outcome.clone(), sent), (Ok(nine), 4));
        assert_eq!(got[1].raw, ">00000009C7");
    }
}

#[test]
fn a_rising_frequency_needs_a_third_answer() {
    let frequency = Counter::ReadFrequency(UpTo::new(0).unwrap()).to(Address(3));
    let script = vec![say(DAMAGED), say(THIRTY), say(SOON), say(SOON)];
    let (got, sent) = played_count(script, &[(count(), 1), (frequency, 1)]);
    assert_eq!(
        (got[1].outcome.clone(), sent),
        (Ok(Reply::Frequency(31)), 4)
    );
}

#[test]
fn a_slow_module_is_not_read_a_third_time() {
    let late = |bytes| vec![(30_000, bytes)];
    let script = vec![say(DAMAGED), late(THIRTY), late(NINE), late(NINE)];
    let (got, sent) = played_count(script, &[(count(), 1), (count(), 1)]);
    assert!(matches!(
        got[1].outcome,
        Err(LineError {
            failure: Failure::Contradicted,
            ..
        })
    ));
    assert_eq!(sent, 3);
}

#[test]
fn other_addresses_and_outputs_need_no_confirmation() {
    let other = Counter::Read(UpTo::new(0).unwrap()).to(Address(5));
    let write = Digital::Write(OutputWord::sixteen(0x1234)).to(Address(3));
    let script = vec![say(DAMAGED), say(THIRTY), say(b">3E\r")];
    let (got, sent) = played_count(script, &[(count(), 1), (other, 1), (write, 1)]);
    assert_eq!(got[1].outcome, Ok(Reply::Count(30)));
    assert_eq!((got[2].outcome.clone(), sent), (Ok(Reply::Accepted), 3));
}

#[test]
fn the_probation_ends_with_a_hundred_whole_answers() {
    let mut script = vec![say(DAMAGED)];
    script.extend(vec![say(THIRTY); 300]);
    let (got, sent) = played_count(script, &[(count(), 1); 61]);
    assert!(got[1..].iter().all(|answer| answer.outcome.is_ok()));
    // The line asks fifty of the requests twice, ten once.
    assert_eq!(sent, 1 + usize::from(PROBATION_ANSWERS) + 10);
}

fn volts() -> Command {
    let form = InputForm::eight(DataFormat::Hex, TypeCode(0x08));
    let channel = Channel::new(0).unwrap();
    AnalogIn::ReadOne { channel, form }.to(Address(1))
}

/// Returns the answer to a reading after damage, and the number of all requests; `said` are the replies of the module.
fn read_of(said: [&'static [u8]; 3]) -> (Answer, usize) {
    let mut script = vec![say(b">1000FE\r")];
    script.extend(said.map(say));
    let (mut got, sent) = played_count(script, &[(volts(), 1), (volts(), 1)]);
    assert!(matches!(
        got[0].outcome,
        Err(LineError {
            failure: Failure::Reply(_),
            ..
        })
    ));
    (got.remove(1), sent)
}

#[test]
fn of_three_moving_readings_the_middle_one_counts() {
    let (got, sent) = read_of([b">1000FF\r", b">200000\r", b">300001\r"]);
    assert_eq!((&*got.raw, sent), (">200000", 4));
    assert!(got.outcome.is_ok(), "{got:?}");
    assert!(got.answered_at.since(got.requested_at) < Span(3_000));
}

#[test]
fn damage_within_the_noise_of_a_reading_is_rejected() {
    let (damaged, whole, near) = (b">002000\r", b">003304\r", b">003405\r");
    for said in [
        [damaged, whole, near],
        [whole, damaged, near],
        [near, whole, damaged],
    ] {
        let (got, _) = read_of(said.map(|bytes| bytes.as_slice()));
        assert_eq!(got.raw, ">003304", "{got:?}");
        // The time stored is that of the accepted answer alone.
        assert!(got.answered_at.since(got.requested_at) < Span(3_000));
    }
}

#[test]
fn a_silent_module_is_not_put_on_probation() {
    let (got, sent) = played_count(vec![vec![], say(THIRTY)], &[(count(), 1), (count(), 1)]);
    assert_eq!((got[1].outcome.clone(), sent), (Ok(Reply::Count(30)), 2));
}
