//! The task of an instrument: runs one program at a time; a later request ends the one under way. Once a channel of the
//! task closes, the task makes the instrument safe.

use super::Link;
use crate::{Pace, Timer};
use scpi::{Failure, Program, Reply};
use tokio::sync::mpsc;
use units::{RigTime, Span};

/// Longest time for the safe program after the last request.
const SAFE_WITHIN: Span = Span::ms(5_000);
/// Tries of the safe program after the last request.
const SAFE_TRIES: u8 = 2;

/// How a program starts on a link that must be brought into step first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Start {
    /// With the set-up before the program.
    SetUp,
    /// Without the set-up, because the program makes the instrument safe.
    Safe,
}

/// A program to run.
#[derive(Debug, Clone, PartialEq)]
pub struct ProgramRequest {
    /// Number of the request, which its answer repeats.
    pub ticket: u64,
    /// The program.
    pub program: Program,
    /// Way in which the program starts on a link that is out of step.
    pub start: Start,
}

/// End of a program.
#[derive(Debug, Clone, PartialEq)]
pub struct ProgramAnswer {
    /// Number of the request.
    pub ticket: u64,
    /// Time at which the program ended.
    pub answered_at: RigTime,
    /// The values of the queries of the program, or the first reason why they are not certain.
    pub outcome: Result<Vec<Reply>, Failure>,
}

/// Runs programs until one of the channels closes, then the program `safe` if the output may be on, so that no source
/// stays on however the cycle ends. A request that arrives while a program runs ends that program, which then has no
/// answer; any other request has exactly one.
///
/// # Errors
/// Fails when the output may still be on: the safe program fails twice, or does not end in time.
pub fn serve(
    link: Link,
    pace: Pace,
    requests: mpsc::Receiver<ProgramRequest>,
    answers: mpsc::Sender<ProgramAnswer>,
    safe: Program,
) -> crate::Task<Result<(), Failure>> {
    let mut task = Task {
        link,
        may_be_on: false,
    };
    // The type is erased here, so that this crate makes the code that polls it (see `crate::task`).
    Box::pin(async move {
        task.run_all(pace, requests, answers).await;
        match task.may_be_on {
            true => task.make_safe(pace, &safe).await,
            false => Ok(()),
        }
    })
}

struct Task {
    link: Link,
    /// True when a program may have left the output on since the last safe program.
    may_be_on: bool,
}

impl Task {
    async fn run_all(
        &mut self,
        pace: Pace,
        mut requests: mpsc::Receiver<ProgramRequest>,
        answers: mpsc::Sender<ProgramAnswer>,
    ) {
        let mut next = requests.recv().await;
        while let Some(request) = next.take() {
            let ticket = request.ticket;
            let outcome = tokio::select! {
                biased;
                later = requests.recv() => {
                    next = later;
                    continue;
                }
                outcome = self.run(request) => outcome,
            };
            let answer = ProgramAnswer {
                ticket,
                answered_at: pace.now(),
                outcome,
            };
            if answers.send(answer).await.is_err() {
                return;
            }
            next = requests.recv().await;
        }
    }

    async fn run(&mut self, request: ProgramRequest) -> Result<Vec<Reply>, Failure> {
        match request.start {
            Start::SetUp => {
                self.may_be_on |= !request.program.steps.is_empty();
                self.link.run(request.program).await
            }
            Start::Safe => {
                let outcome = self.link.make_safe(request.program).await;
                self.may_be_on = outcome.is_err();
                outcome
            }
        }
    }

    async fn make_safe(&mut self, pace: Pace, safe: &Program) -> Result<(), Failure> {
        let end = pace.now() + SAFE_WITHIN;
        let timer = Timer::new(pace);
        let mut outcome = Ok(());
        for _ in 0..SAFE_TRIES {
            outcome = tokio::select! {
                biased;
                outcome = self.link.make_safe(safe.clone()) => outcome.map(|_| ()),
                () = timer.until(end) => return Err(Failure::Overdue { limit: SAFE_WITHIN }),
            };
            if outcome.is_ok() {
                break;
            }
        }
        outcome
    }
}
