//! Tests with conformance vectors from the manuals of the named modules: decoded whole, cut off, and with each bit
//! damaged.

use super::sealed;
use crate::{Model, decode_request, interpret};
use proptest::prelude::*;

/// Model, request, reply and meaning, separated by tabs; frames without checksum and CR.
const VECTORS: &str = include_str!("vectors.txt");

struct Vector {
    model: &'static str,
    request: &'static str,
    reply: &'static str,
    meaning: &'static str,
}

fn vectors() -> Vec<Vector> {
    let rows = VECTORS.lines().filter(|row| !row.starts_with('#'));
    rows.map(|row| {
        let cells: Vec<&str> = row.split('\t').collect();
        let [model, request, reply, meaning] = cells[..] else {
            panic!("{row}")
        };
        Vector {
            model,
            request,
            reply,
            meaning,
        }
    })
    .collect()
}

/// Returns what the reply may mean when a module of this model sends it, each meaning once.
fn said(vector: &Vector, reply: &[u8], checksum: bool) -> Vec<String> {
    let model = Model::of_name(vector.model).unwrap();
    let request = sealed(vector.request, checksum);
    let mut said: Vec<String> = interpret(&request, reply, checksum, Some(model))
        .into_iter()
        .map(|(command, reply)| match reply {
            Ok(reply) => command.describe_reply(&reply, Some(model)).to_string(),
            Err(reason) => reason.to_string(),
        })
        .collect();
    said.sort();
    said.dedup();
    said
}

#[test]
fn every_vector_decodes_as_its_manual_states() {
    for vector in vectors() {
        for checksum in [false, true] {
            let said = said(&vector, &sealed(vector.reply, checksum), checksum);
            let wanted = vector.meaning;
            assert!(
                said.iter().any(|said| said == wanted),
                "{} {} {}: {said:?}, expected {wanted}",
                vector.model,
                vector.request,
                vector.reply
            );
        }
    }
}

#[test]
fn no_truncated_vector_decodes_to_a_value() {
    for vector in vectors() {
        let model = Model::of_name(vector.model).unwrap();
        for checksum in [false, true] {
            let whole = sealed(vector.reply, checksum);
            for command in decode_request(vector.request.as_bytes())
                .into_iter()
                .filter(|it| model.has_command(it))
            {
                // Skips commands that refuse even the whole reply.
                if command.decode(&whole, checksum).is_err() {
                    continue;
                }
                for length in 0..whole.len() - 1 {
                    let outcome = command.decode(&whole[..length], checksum);
                    assert!(
                        outcome.is_err(),
                        "{command} {} to {length}: {outcome:?}",
                        vector.reply
                    );
                }
            }
        }
    }
}

#[test]
fn no_vector_with_one_wrong_bit_passes_the_checksum() {
    for vector in vectors() {
        let whole = sealed(vector.reply, true);
        for command in decode_request(vector.request.as_bytes()) {
            for (at, bit) in (0..whole.len()).flat_map(|at| (0..8).map(move |bit| (at, bit))) {
                let mut damaged = whole.clone();
                damaged[at] ^= 1 << bit;
                let outcome = command.decode(&damaged, true);
                assert!(
                    matches!(outcome, Err(reason) if !reason.is_answer()),
                    "{command} {} bit {bit} of {at}: {outcome:?}",
                    vector.reply
                );
            }
        }
    }
}

#[test]
fn without_checksum_the_range_still_refuses_damaged_values() {
    use super::{A1, PERCENT, PT100, VOLTS, ch};
    use crate::{AnalogIn, Digital};
    let one = |form| {
        AnalogIn::ReadOne {
            channel: ch(0),
            form,
        }
        .to(A1)
    };
    for (command, reply) in [
        (one(VOLTS), ">+42.513\r"),
        (one(PERCENT), ">+202.51\r"),
        (one(PT100), ">+525.37\r"),
        (one(VOLTS), ">4C53\r"),
        (Digital::ReadPort.to(A1), ">0000001E\r"),
        (Digital::ReadAll.to(A1), "!0F000A\r"),
    ] {
        assert!(
            command.decode(reply.as_bytes(), false).is_err(),
            "{command} {reply}"
        );
    }
}

#[test]
fn factory_commands_are_recognised_by_their_characters() {
    use crate::factory_command;
    for request in [
        "$010",
        "$011",
        "$0103",
        "$0112",
        "~01E1",
        "$01305",
        "$013005",
        "$019+0010",
        "$010C2",
        "~01E0",
    ] {
        assert!(factory_command(request.as_bytes()).is_some(), "{request}");
    }
    for vector in vectors() {
        assert_eq!(
            factory_command(vector.request.as_bytes()),
            None,
            "{}",
            vector.request
        );
    }
}

proptest! {
    #[test]
    fn no_bytes_make_the_reading_of_a_request_panic(request in "[#$%@~]?[\\x00-\\x7F]{0,24}", reply in "[!>?]?[ -~]{0,20}\r?", sum: bool) {
        for command in decode_request(request.as_bytes()) {
            let mut written = Vec::new();
            command.encode(false, &mut written);
            let written = written.strip_suffix(b"\r").unwrap_or_default();
            // Only `#AABBDD`, seven characters, has two spellings.
            prop_assert!(written == request.as_bytes() || request.len() == 7);
            prop_assert!(decode_request(written).contains(&command));
        }
        let _ = interpret(request.as_bytes(), reply.as_bytes(), sum, None);
    }
}
