//! Tests: a line stays in step; it never takes a late reply for the answer to a later request.

use super::*;

/// Two modules: 03, which serves its requests in order and sends its first count `late` microseconds after the request,
/// and 05, whose counts take 2 ms. The count tells the module: 03 replies 30, 05 replies 9. Module 05 leaves the first
/// `dead` requests unanswered.
async fn neighbours(mut stream: DuplexStream, pace: Pace, late: u64, dead: usize) {
    let (slow_in, mut slow_out) = mpsc::unbounded_channel::<String>();
    let (say_in, mut say_out) = mpsc::unbounded_channel::<Vec<u8>>();
    let slow_say = say_in.clone();
    tokio::spawn(async move {
        let mut first = true;
        while let Some(request) = slow_out.recv().await {
            let think = if first { late } else { 2_000 };
            first = false;
            pace.sleep_until(pace.now() + Span(think)).await;
            let _ = slow_say.send(named(&request).map_or_else(|| THIRTY.to_vec(), Into::into));
        }
    });
    let mut unanswered = dead;
    loop {
        tokio::select! {
            biased;
            Some(bytes) = say_out.recv() => { let _ = stream.write_all(&bytes).await; }
            request = next_request(&mut stream) => {
                let Some(request) = request else { return };
                if request[1..].starts_with("03") {
                    let _ = slow_in.send(request);
                    continue;
                }
                if unanswered > 0 && named(&request).is_none() {
                    unanswered -= 1;
                    continue;
                }
                let say = say_in.clone();
                tokio::spawn(async move {
                    pace.sleep_until(pace.now() + Span(2_000)).await;
                    let _ = say.send(named(&request).map_or_else(|| NINE.to_vec(), Into::into));
                });
            }
        }
    }
}

fn neighbour() -> Command {
    Counter::Read(UpTo::new(0).unwrap()).to(Address(5))
}

/// Sends one request to the slow module, then requests to the fast one for half a second; returns the answers.
fn answers(late: u64, dead: usize) -> Vec<Answer> {
    in_virtual_time(async {
        let pace = Pace::virtual_time();
        let (ours, theirs) = duplex(4096);
        let (ask, to_line) = mpsc::channel(1);
        let (from_line, mut answers) = mpsc::channel(1);
        tokio::spawn(run(ours, settings(), pace, to_line, from_line));
        tokio::spawn(neighbours(theirs, pace, late, dead));
        let mut got = Vec::new();
        let mut command = count();
        while pace.now() < RigTime(500_000) {
            let ticket = got.len() as u64;
            let tries = 1;
            ask.send(Request {
                ticket,
                command,
                tries,
            })
            .await
            .unwrap();
            got.push(answers.recv().await.unwrap());
            command = neighbour();
        }
        got
    })
}

#[test]
fn a_late_reply_never_counts_for_another_module() {
    for late in (1..90).map(|step| step * 4_937) {
        let got = answers(late, 0);
        let limit = settings().time_out(&count()).0;
        assert_eq!(got[0].outcome.is_ok(), late < limit, "{late}: {:?}", got[0]);
        for answer in &got[1..] {
            assert!(
                matches!(answer.outcome, Ok(Reply::Count(9)) | Err(_)),
                "late by {late}: {answer:?}"
            );
        }
        let lost = got[1..]
            .iter()
            .filter(|answer| answer.outcome.is_err())
            .count();
        assert!(lost <= 2, "late by {late}: {lost} of {}", got.len());
    }
}

#[test]
fn a_late_reply_never_replaces_a_lost_one() {
    for late in (1..90).map(|step| step * 4_937) {
        for answer in &answers(late, 3)[1..] {
            assert_ne!(
                answer.outcome,
                Ok(Reply::Count(30)),
                "late by {late}: {answer:?}"
            );
        }
    }
}

#[test]
fn a_module_that_names_itself_ends_the_wait_for_silence() {
    let (got, _) = in_virtual_time(played(
        settings(),
        vec![vec![], vec![(2_000, NINE)]],
        &[(count(), 1), (count(), 1)],
    ));
    let spent = got[1].requested_at.since(got[0].answered_at);
    assert!(spent < Span(2_500), "{spent:?}");
    assert_eq!(got[1].outcome, Ok(Reply::Count(9)));
}

#[test]
fn no_transaction_takes_longer_than_its_bound() {
    let bound = longest_transaction(&settings(), &[count()]);
    for late in [0, 40_000, 70_000, 100_000, 450_000] {
        for pair in answers(late, 2).windows(2) {
            let taken = pair[1].requested_at.since(pair[0].requested_at);
            assert!(taken <= bound, "late by {late}: {taken:?}");
        }
    }
}
