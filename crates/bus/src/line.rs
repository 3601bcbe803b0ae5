//! The task of a line: takes one request at a time and returns the answers in the same order.

use super::exchange::{Exchange, Frame};
use super::from_streams;
use super::log::Records;
use super::outstanding::OutstandingReplies;
use super::probation::Probation;
use super::transaction::{Times, Transaction};
use super::{
    Answer, Failure, LineError, LineSettings, OpenPort, Pace, Port, PortError, Request, Task, Timer,
};
use dcon::{Command, Common, FRAME_LIMIT, Reply};
use tokio::sync::mpsc;
use units::{RigTime, Span};

/// Serves requests over `port` until one of the channels closes. Every request gets an answer.
pub async fn run(
    port: impl Port + 'static,
    settings: LineSettings,
    pace: Pace,
    requests: mpsc::Receiver<Request>,
    answers: mpsc::Sender<Answer>,
) {
    let mut port = Some(port);
    let once = from_streams(move || port.take());
    run_reopening(once, settings, pace, requests, answers).await;
}

/// Serves requests as [`run`] does, over ports that it opens itself: the first one at the first request, and after a
/// loss another one, at most once per back-off time.
pub fn run_reopening(
    open: OpenPort,
    settings: LineSettings,
    pace: Pace,
    requests: mpsc::Receiver<Request>,
    answers: mpsc::Sender<Answer>,
) -> Task {
    let line = Line::new(open, settings, pace);
    Box::pin(line.run(requests, answers))
}

struct Line {
    open: OpenPort,
    port: Option<Box<dyn Port>>,
    settings: LineSettings,
    pace: Pace,
    timer: Timer,
    request: Vec<u8>,
    frame: Frame,
    /// False after trouble, until the line has been silent for the required time.
    silent: bool,
    outstanding: OutstandingReplies,
    probation: Probation,
    reopen_at: RigTime,
    backoff: Span,
    lost_because: PortError,
}

/// One try: when it began and ended, and its outcome.
struct Try {
    requested_at: RigTime,
    answered_at: RigTime,
    outcome: Result<Reply, LineError>,
}

impl Line {
    /// Creates a line without an open port.
    fn new(open: OpenPort, settings: LineSettings, pace: Pace) -> Self {
        let backoff = Span::ms(settings.reopen_first_ms);
        Self {
            open,
            port: None,
            settings,
            pace,
            timer: Timer::new(pace),
            request: Vec::with_capacity(24),
            frame: Frame::new(),
            silent: true,
            outstanding: OutstandingReplies::default(),
            probation: Probation::default(),
            reopen_at: RigTime(0),
            backoff,
            lost_because: PortError::Gone,
        }
    }

    async fn run(mut self, mut requests: mpsc::Receiver<Request>, answers: mpsc::Sender<Answer>) {
        while let Some(request) = requests.recv().await {
            let answer = self.serve(request).await;
            assert_eq!(
                answer.ticket, request.ticket,
                "the answer has another ticket"
            );
            assert_eq!(
                answer.command, request.command,
                "the answer has another command"
            );
            if answers.send(answer).await.is_err() {
                return;
            }
        }
    }

    /// Serves a request. Writes a setting only if the module has another value, because EEPROMs wear, or if the module
    /// refuses to report it.
    async fn serve(&mut self, request: Request) -> Answer {
        let Some(setting) = request.command.setting() else {
            return self.carry_out(request).await;
        };
        let found = self
            .carry_out(Request {
                command: setting,
                ..request
            })
            .await;
        let outcome = match found.outcome {
            Ok(reply) if request.command.is_in_effect(&reply) => Ok(Reply::Accepted),
            Ok(_) => return self.carry_out(request).await,
            Err(error) if error.failure.is_answer() => {
                return self.carry_out(request).await;
            }
            Err(error) => Err(error),
        };
        Answer {
            command: request.command,
            outcome,
            ..found
        }
    }

    async fn carry_out(&mut self, request: Request) -> Answer {
        let command = request.command;
        self.request.clear();
        command.encode(self.settings.checksum, &mut self.request);
        assert_eq!(
            self.request.last(),
            Some(&b'\r'),
            "the request does not end with CR"
        );
        assert!(
            self.request.len() <= FRAME_LIMIT,
            "the request is longer than a frame"
        );
        let mut tries_used = 0u8;
        let last = loop {
            tries_used += 1;
            self.frame.clear();
            let attempt = self.attempt(&command).await;
            self.count(&command, &attempt);
            if tries_used >= request.tries || !may_repeat(&command, &attempt.outcome) {
                break attempt;
            }
        };
        let text = self.frame.bytes();
        let raw = String::from_utf8_lossy(text.strip_suffix(b"\r").unwrap_or(text)).into_owned();
        let Try {
            requested_at,
            answered_at,
            outcome,
        } = last;
        assert!(
            answered_at >= requested_at,
            "the answer precedes its request"
        );
        assert!(
            tries_used == 1 || tries_used <= request.tries,
            "more tries than the request allows"
        );
        Answer {
            ticket: request.ticket,
            command,
            outcome,
            raw,
            requested_at,
            answered_at,
            tries_used,
        }
    }

    async fn attempt(&mut self, command: &Command) -> Try {
        let mut times = Times {
            requested_at: self.pace.now(),
            answered_at: None,
        };
        let result = self.transact(command, &mut times).await;
        match &result {
            Err(Failure::PortLost(why)) if self.port.is_some() => self.lost(why.clone()),
            Ok(_) => self.backoff = Span::ms(self.settings.reopen_first_ms),
            Err(_) => {}
        }
        Try {
            requested_at: times.requested_at,
            answered_at: times.answered_at.unwrap_or_else(|| self.pace.now()),
            outcome: result.map_err(|failure| LineError {
                line: self.settings.name.clone(),
                command: *command,
                failure,
            }),
        }
    }

    async fn transact(&mut self, command: &Command, times: &mut Times) -> Result<Reply, Failure> {
        self.reopened(command).await?;
        let Some(port) = &mut self.port else {
            return Err(Failure::PortLost(self.lost_because.clone()));
        };
        let mut transaction = Transaction {
            exchange: Exchange {
                port: port.as_mut(),
                pace: self.pace,
                timer: &self.timer,
                log: &self.settings.log,
            },
            settings: &self.settings,
            outstanding: &mut self.outstanding,
            probation: &mut self.probation,
            silent: &mut self.silent,
        };
        transaction
            .transact(command, &self.request, &mut self.frame, times)
            .await
    }

    /// Opens the port if none is open. Without a port a request takes as long as with a silent module, so that a caller
    /// that repeats requests does not spin.
    async fn reopened(&mut self, command: &Command) -> Result<(), Failure> {
        if self.port.is_some() {
            return Ok(());
        }
        if self.pace.now() >= self.reopen_at {
            match (self.open)() {
                Ok(port) => {
                    self.port = Some(port);
                    self.silent = true;
                    return Ok(());
                }
                Err(reason) => self.lost(reason),
            }
        }
        self.pace
            .sleep_until(self.pace.now() + self.settings.time_out(command))
            .await;
        Err(Failure::PortLost(self.lost_because.clone()))
    }

    /// Drops the port. The line reopens it after the back-off time, which doubles until a transaction succeeds.
    fn lost(&mut self, reason: PortError) {
        self.port = None;
        self.lost_because = reason;
        self.reopen_at = self.pace.now() + self.backoff;
        let longest = Span::ms(self.settings.reopen_longest_ms);
        assert!(self.backoff > Span(0), "the back-off is zero");
        self.backoff = (self.backoff + self.backoff).min(longest);
    }

    fn count(&self, command: &Command, attempt: &Try) {
        let Some(address) = command.address() else {
            return;
        };
        let on_wire = self
            .settings
            .wire()
            .time(self.request.len() + self.frame.bytes().len());
        let taken = attempt.answered_at.since(attempt.requested_at);
        let latency = Span(taken.0.saturating_sub(on_wire.0));
        let reads_reset = matches!(command, Command::Common(_, Common::ReadResetStatus));
        let outcome = attempt.outcome.clone();
        let count =
            move |it: &mut Records| it.health.count(address, reads_reset, &outcome, latency);
        self.settings.log.write(count);
    }
}

/// Returns true when the command only reads and a repetition may cure its failure.
fn may_repeat(command: &Command, outcome: &Result<Reply, LineError>) -> bool {
    let may_be_cured = |error: &LineError| {
        let lost = matches!(error.failure, Failure::PortLost(_));
        !lost && !error.failure.is_answer()
    };
    command.repeatable() && outcome.as_ref().is_err_and(may_be_cured)
}
