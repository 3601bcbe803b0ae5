//! The run of a program: its steps, then the proof that its replies are its own.
//!
//! The proof is the error queue, read until it is empty, an event register without loss of power, and the number that
//! the previous program left in the instrument: a reply too many or too few shifts one of them to another query.

use super::failure::Failure;
use super::nonce::Nonce;
use super::program::{Program, Step};
use super::reply::{Form, Raw, Reply, ReplyError};
use super::session::{Move, Question};
use super::settings::{Echo, LinkSettings};
use super::status::{ErrorClass, ErrorEntry, StandardEvents};
use units::Span;

/// Present point of a run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum At {
    /// Before the step with this number; `repeated` when the link asks its query again, because its first reply
    /// equalled the previous reply.
    Step {
        number: usize,
        repeated: bool,
    },
    /// After this failure of a query: asks the instrument for the reason.
    Why(Failure),
    /// Reads the error queue; the number counts the entries so far.
    Errors(u8),
    /// Reads the event register, which keeps a loss of power until it is read.
    Events,
    /// Reads the number that proves that the link is in step.
    Echo,
    /// Leaves the next number in the instrument.
    Mark,
    End,
}

#[derive(Debug)]
pub(crate) struct Run {
    program: Program,
    pub(crate) at: At,
    values: Vec<Reply>,
    /// First failure after which the link is still in step.
    failure: Option<Failure>,
}

impl Run {
    pub(crate) fn new(program: Program) -> Self {
        let at = match program.steps.is_empty() {
            true => At::Errors(0),
            false => At::Step {
                number: 0,
                repeated: false,
            },
        };
        Self {
            program,
            at,
            values: Vec::new(),
            failure: None,
        }
    }

    pub(crate) fn next_move(&self, settings: &LinkSettings, nonce: &Nonce) -> Move {
        let limit = settings.limit;
        let ask = |command: &str, form, limit: Span| {
            Move::Ask(Question::new(settings.framing, command, form, limit))
        };
        let send = |command: &str| {
            let (bytes, tail) = settings.framing.proven(settings.framing.send(command));
            Move::Send { bytes, limit, tail }
        };
        match &self.at {
            At::Step { number, .. } => match self.program.steps.get(*number) {
                Some(Step::Send(command)) => send(command),
                Some(Step::Ask {
                    command,
                    form,
                    limit: own,
                    ..
                }) => ask(command, *form, own.unwrap_or(limit)),
                None => Move::Done(Ok(Vec::new())),
            },
            At::Why(_) | At::Errors(_) => ask("SYST:ERR?", Form::Line, limit),
            At::Events => ask("*ESR?", Form::Line, limit),
            At::Echo if settings.echo == Echo::Identity => ask("*IDN?", Form::Line, limit),
            At::Echo => ask("*ESE?", Form::Line, limit),
            At::Mark => send(&format!("*ESE {}", nonce.current())),
            At::End => Move::Done(Ok(Vec::new())),
        }
    }

    /// Takes the outcome of a move; returns the result when the run ends. `echo` is the reply that proves that the link
    /// is in step, `is_copy` says that the reply may be a copy of the previous one.
    pub(crate) fn advance(
        &mut self,
        settings: &LinkSettings,
        echo: &str,
        outcome: Result<Option<Raw>, Failure>,
        is_copy: bool,
    ) -> Option<Result<Vec<Reply>, Failure>> {
        let at = std::mem::replace(&mut self.at, At::End);
        let next = match (at, outcome) {
            (At::Why(timeout), outcome) => match outcome.and_then(|raw| entry(raw.as_ref())) {
                Ok(entry) if refuses(entry.class()) => self.after_entry(settings, 0, entry),
                Ok(_) | Err(_) => Err(timeout),
            },
            (At::Step { number, repeated }, outcome) => {
                self.after_step(number, outcome, is_copy && !repeated)
            }
            (_, Err(failure)) => Err(failure),
            (At::Errors(count), Ok(raw)) => {
                entry(raw.as_ref()).and_then(|it| self.after_entry(settings, count, it))
            }
            (At::Events, Ok(raw)) => after_events(raw.as_ref()),
            (At::Echo, Ok(raw)) => after_echo(settings, echo, raw.as_ref()),
            (At::Mark | At::End, Ok(_)) => Ok(At::End),
        };
        match next {
            Err(failure) => Some(Err(failure)),
            Ok(At::End) => Some(match self.failure.take() {
                Some(failure) => Err(failure),
                None => Ok(std::mem::take(&mut self.values)),
            }),
            Ok(at) => {
                self.at = at;
                None
            }
        }
    }

    fn after_step(
        &mut self,
        number: usize,
        outcome: Result<Option<Raw>, Failure>,
        is_copy: bool,
    ) -> Result<At, Failure> {
        let raw = match outcome {
            Ok(_) if is_copy => {
                return Ok(At::Step {
                    number,
                    repeated: true,
                });
            }
            Ok(raw) => raw,
            // An instrument does not answer a query that it does not know, but queues an error.
            Err(failure @ Failure::Timeout { .. }) => return Ok(At::Why(failure)),
            Err(failure) => return Err(failure),
        };
        if let (
            Some(Step::Ask {
                command,
                form,
                expect,
                ..
            }),
            Some(raw),
        ) = (self.program.steps.get(number), raw)
        {
            match value(command, *form, expect.as_deref(), &raw) {
                Ok(value) => self.values.extend(value),
                Err(failure) if failure.is_doubt() => return Err(failure),
                Err(failure) => {
                    self.failure.get_or_insert(failure);
                }
            }
        }
        Ok(match number + 1 == self.program.steps.len() {
            true => At::Errors(0),
            false => At::Step {
                number: number + 1,
                repeated: false,
            },
        })
    }

    /// Takes an entry of the error queue; `count` is the number of entries before it.
    fn after_entry(
        &mut self,
        settings: &LinkSettings,
        count: u8,
        entry: ErrorEntry,
    ) -> Result<At, Failure> {
        let failure = match entry.class() {
            ErrorClass::None => return Ok(At::Events),
            ErrorClass::Overflow => return Err(Failure::QueueOverflow),
            ErrorClass::Local => return Err(Failure::Local { text: entry.text }),
            ErrorClass::Command | ErrorClass::Execution | ErrorClass::Device => instrument(entry),
            ErrorClass::Query | ErrorClass::Other => instrument(entry),
        };
        self.failure.get_or_insert(failure);
        match count < settings.error_depth {
            true => Ok(At::Errors(count + 1)),
            false => Err(Failure::QueueOverflow),
        }
    }
}

/// Reads the reply to `*ESR?`.
pub(crate) fn events(raw: Option<&Raw>) -> Result<StandardEvents, Failure> {
    let line = raw.map_or(Err(ReplyError::Empty), Raw::text);
    let events = line.and_then(|line| {
        let found = line.to_owned();
        let events = line.parse().map(StandardEvents);
        events.map_err(|_| ReplyError::NotNumber { found })
    });
    events.map_err(|reason| malformed("*ESR?", reason))
}

fn after_events(raw: Option<&Raw>) -> Result<At, Failure> {
    match events(raw)?.power_on() {
        true => Err(Failure::PowerCycled),
        false => Ok(At::Echo),
    }
}

fn instrument(entry: ErrorEntry) -> Failure {
    Failure::Instrument {
        code: entry.code,
        text: entry.text,
    }
}

fn malformed(command: &str, reason: ReplyError) -> Failure {
    Failure::Malformed {
        command: command.to_owned(),
        reason,
    }
}

fn entry(raw: Option<&Raw>) -> Result<ErrorEntry, Failure> {
    let text = raw.map_or(Err(ReplyError::Empty), Raw::text);
    text.and_then(ErrorEntry::read)
        .map_err(|reason| malformed("SYST:ERR?", reason))
}

/// Returns true when an error of this class explains a missing reply: the instrument did not carry out the query.
fn refuses(class: ErrorClass) -> bool {
    match class {
        ErrorClass::Command | ErrorClass::Execution => true,
        ErrorClass::Local | ErrorClass::Overflow => true,
        ErrorClass::None | ErrorClass::Device | ErrorClass::Query | ErrorClass::Other => false,
    }
}

/// Returns the value of a reply; `None` for a setting that reads back as expected.
fn value(
    command: &str,
    form: Form,
    expect: Option<&str>,
    raw: &Raw,
) -> Result<Option<Reply>, Failure> {
    if let Some(expected) = expect {
        let found = raw.text().map_err(|reason| malformed(command, reason))?;
        if same(found, expected) {
            return Ok(None);
        }
        let (found, expected) = (found.to_owned(), expected.to_owned());
        return Err(Failure::ReadBack {
            command: command.to_owned(),
            found,
            expected,
        });
    }
    let own = || command.to_owned();
    form.read(raw).map(Some).map_err(|reason| match reason {
        ReplyError::OverRange => Failure::OverRange { command: own() },
        ReplyError::NotANumber => Failure::NotANumber { command: own() },
        reason => malformed(command, reason),
    })
}

/// Returns true when both are the same text or, within 1e-6, the same number: `+1.0000E+00` reads back what `1` has
/// set.
fn same(found: &str, expected: &str) -> bool {
    let numbers = (crate::number(found), crate::number(expected));
    match numbers {
        (Ok(found), Ok(expected)) => (found - expected).abs() <= 1e-6 * expected.abs(),
        (Ok(_) | Err(_), Ok(_) | Err(_)) => found.eq_ignore_ascii_case(expected),
    }
}

/// Compares the echo. After a right echo that is a number, the run leaves a new number, so that no later echo equals
/// this one.
fn after_echo(settings: &LinkSettings, echo: &str, raw: Option<&Raw>) -> Result<At, Failure> {
    let line = raw.and_then(|it| it.text().ok()).unwrap_or_default();
    match (same(line, echo), settings.echo) {
        (true, Echo::Ese) => Ok(At::Mark),
        (true, Echo::Identity) => Ok(At::End),
        (false, Echo::Ese) => Err(Failure::OutOfStep {
            command: "*ESE?".to_owned(),
        }),
        (false, Echo::Identity) => Err(Failure::Identity {
            found: line.to_owned(),
            expected: format!("{echo:?}"),
        }),
    }
}
