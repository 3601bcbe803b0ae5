//! The task of an instrument: runs one program at a time; a later request ends the one under way.

use super::Link;
use crate::Pace;
use scpi::{Failure, Program, Reply};
use tokio::sync::mpsc;
use units::RigTime;

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
    /// How it starts.
    pub start: Start,
}

/// End of a program.
#[derive(Debug, Clone, PartialEq)]
pub struct ProgramAnswer {
    /// Number of the request.
    pub ticket: u64,
    /// Time at which the program ended.
    pub answered_at: RigTime,
    /// The values of its queries, or the first reason why they are not certain.
    pub outcome: Result<Vec<Reply>, Failure>,
}

/// Runs programs until one of the channels closes. A request that arrives while a program runs ends that program, which
/// then has no answer; any other request has exactly one.
pub async fn serve(
    mut link: Link,
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
            outcome = run(&mut link, request) => outcome,
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

async fn run(link: &mut Link, request: ProgramRequest) -> Result<Vec<Reply>, Failure> {
    match request.start {
        Start::SetUp => link.run(request.program).await,
        Start::Safe => link.make_safe(request.program).await,
    }
}
