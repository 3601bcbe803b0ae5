//! Tests: a busy host wakes late, and its clock advances between two lines of code. Neither makes a module seem silent.

use super::*;
use crate::outstanding::identification;
use std::collections::VecDeque;
use std::io;
use std::pin::Pin;
use std::task::{Context, Poll};
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};

/// Port of a host that sleeps until the instant beside each piece: the piece lies in its buffer long before, but the
/// reactor notices it only at the second poll after the wake-up.
struct Unnoticed {
    pace: Pace,
    pieces: VecDeque<(RigTime, &'static [u8])>,
    awake: bool,
}

impl AsyncRead for Unnoticed {
    fn poll_read(
        mut self: Pin<&mut Self>,
        _: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let asleep_until = self.pieces.front().map(|it| it.0);
        let sleeps = asleep_until.is_none_or(|at| self.pace.now() < at);
        if sleeps || !std::mem::replace(&mut self.awake, true) {
            return Poll::Pending;
        }
        self.awake = false;
        let (_, piece) = self.pieces.pop_front().unwrap();
        buffer.put_slice(piece);
        Poll::Ready(Ok(()))
    }
}

impl AsyncWrite for Unnoticed {
    fn poll_write(
        self: Pin<&mut Self>,
        _: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        Poll::Ready(Ok(bytes.len()))
    }

    fn poll_flush(self: Pin<&mut Self>, _: &mut Context<'_>) -> Poll<io::Result<()>> {
        Poll::Ready(Ok(()))
    }

    fn poll_shutdown(self: Pin<&mut Self>, _: &mut Context<'_>) -> Poll<io::Result<()>> {
        Poll::Ready(Ok(()))
    }
}

/// Sends one request through `port`.
async fn exchange(port: impl Port + 'static, pace: Pace, command: Command) -> Answer {
    let (ask, to_line) = mpsc::channel(1);
    let (from_line, mut answers) = mpsc::channel(1);
    let request = Request {
        ticket: 0,
        command,
        tries: 1,
    };
    ask.send(request).await.unwrap();
    drop(ask);
    let (answer, ()) = tokio::join!(
        answers.recv(),
        run(port, settings(), pace, to_line, from_line)
    );
    answer.unwrap()
}

#[test]
fn a_reply_that_waited_for_the_host_counts() {
    let limit = settings().time_out(&count());
    let heard = answer(vec![(RigTime(0) + limit, THIRTY)]);
    assert_eq!(heard.outcome, Ok(Reply::Count(30)));
    assert_eq!(heard.answered_at.since(heard.requested_at), limit);
    assert!(is_silent(&answer(vec![])));
}

#[test]
fn half_a_reply_that_waited_is_no_answer() {
    let asked_until = RigTime(0) + settings().time_out(&count());
    let half: &[u8] = b">0000";
    assert!(is_silent(&answer(vec![(asked_until, half)])));
    // The module also has half a name when the wait for its name ends.
    let named_until =
        asked_until + settings().time_out(&identification(count().address().unwrap()));
    assert!(is_silent(&answer(vec![
        (asked_until, half),
        (named_until, b"!0170"),
    ])));
}

/// Returns the answer to a request whose reply comes in `pieces`.
fn answer(pieces: Vec<(RigTime, &'static [u8])>) -> Answer {
    in_virtual_time(async move {
        let pace = Pace::virtual_time();
        let port = Unnoticed {
            pace,
            pieces: pieces.into(),
            awake: false,
        };
        exchange(port, pace, count()).await
    })
}

fn is_silent(answer: &Answer) -> bool {
    matches!(
        answer.outcome,
        Err(LineError {
            failure: Failure::TimeOut(_),
            ..
        })
    )
}

#[test]
fn a_silent_module_must_name_itself_in_real_time() {
    let name_requests = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()
        .unwrap()
        .block_on(async {
            let pace = Pace::real();
            let (ours, mut theirs) = duplex(64);
            let module = async move {
                let mut names = 0;
                while let Some(request) = next_request(&mut theirs).await {
                    if let Some(name) = named(&request) {
                        names += 1;
                        let _ = theirs.write_all(name.as_bytes()).await;
                    }
                }
                names
            };
            let (names, answer) = tokio::join!(module, exchange(ours, pace, count()));
            assert!(matches!(
                answer.outcome,
                Err(LineError {
                    failure: Failure::TimeOut(_),
                    ..
                })
            ));
            names
        });
    assert_eq!(name_requests, 1);
}
