//! Replays the conversations of `conformance.txt`, and damaged requests that must get no answer.

use rigsim::bench;
use rigsim::rig::Rig;

const CONVERSATIONS: &str = include_str!("../conformance.txt");

/// Rig time between two requests, microseconds.
const TURN_US: u64 = 1;

fn ask(rig: &mut Rig, request: &str, at_us: u64) -> String {
    let reply = rig.exchange(0, request.as_bytes(), at_us);
    let text = reply.map_or_else(String::new, |reply| {
        String::from_utf8_lossy(&reply.bytes).into_owned()
    });
    text.trim_end_matches('\r').to_owned()
}

fn converse(block: &str, line_number: usize) -> usize {
    let of = |mark: char| block.lines().filter(move |line| line.starts_with(mark));
    let file: Vec<&str> = of('=').map(|line| line[1..].trim()).collect();
    let mut rig = bench::build_text(&file.join("\n"))
        .unwrap_or_else(|error| panic!("line {line_number}: {error}"));
    let (mut now_us, mut request, mut asked) = (0, "", 0);
    for line in block.lines() {
        let text = line.get(1..).unwrap_or("");
        let text = text.strip_prefix(' ').unwrap_or(text);
        match line.chars().next() {
            Some('@') => now_us += text.trim().parse::<u64>().expect("milliseconds") * 1_000,
            Some('>') => request = text,
            Some('<') => {
                now_us += TURN_US;
                let reply = ask(&mut rig, request, now_us);
                assert_eq!(reply, text, "line {line_number} ff: {request} of\n{block}");
                asked += 1;
            }
            _ => {}
        }
    }
    asked
}

#[test]
fn modules_answer_as_documented() {
    let mut asked = 0;
    let mut line_number = 1;
    for block in CONVERSATIONS.split("\n\n") {
        if block.lines().any(|line| line.starts_with('>')) {
            asked += converse(block, line_number);
        }
        line_number += block.lines().count() + 1;
    }
    assert!(asked > 200, "only {asked} requests found");
}

/// Returns every request of the conversations with a checksum, as (bench, request).
fn checked_requests() -> Vec<(String, &'static str)> {
    let mut found = Vec::new();
    for block in CONVERSATIONS.split("\n\n") {
        let lines = |mark: char| block.lines().filter(move |line| line.starts_with(mark));
        let file: Vec<&str> = lines('=').map(|line| line[1..].trim()).collect();
        if file.contains(&"checksum = true") {
            found.extend(lines('>').map(|line| (file.join("\n"), &line[2..])));
        }
    }
    found
}

#[test]
fn with_checksum_a_damaged_request_gets_no_answer() {
    for (file, request) in checked_requests() {
        let mut rig = bench::build_text(&file).expect("a bench");
        if ask(&mut rig, request, 0).is_empty() {
            continue;
        }
        for bit in 0..request.len() * 8 {
            let mut bytes = request.as_bytes().to_vec();
            bytes[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(rig.exchange(0, &bytes, 0), None, "{request} bit {bit}");
        }
        for length in 0..request.len() {
            let cut = &request.as_bytes()[..length];
            assert_eq!(rig.exchange(0, cut, 0), None, "{request} cut to {length}");
        }
    }
}
