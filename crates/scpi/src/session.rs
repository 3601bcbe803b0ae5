//! The state machine of a link, without a stream and without a clock: it returns the next move, and its caller reports
//! how the move ended. Every move has a time limit, and the number of moves of a program is bounded.

use super::failure::Failure;
use super::framing::Framing;
use super::nonce::Nonce;
use super::program::Program;
use super::reply::{Form, Raw, Reply};
use super::run::{At, Run, events};
use super::settings::{Echo, LinkSettings};
use super::status::Identity;
use std::mem;
use units::Span;

/// Next move, which the caller carries out.
#[derive(Debug, Clone, PartialEq)]
pub enum Move {
    /// Closes the stream, waits, opens a new one.
    Open {
        /// Wait before opening.
        after: Span,
        /// Time for opening.
        limit: Span,
    },
    /// Writes bytes.
    Send {
        /// Bytes, terminator included.
        bytes: Vec<u8>,
        /// Time for writing, and for the line that must follow.
        limit: Span,
        /// Line that must follow: the address of a GPIB adapter, which proves who received the command.
        tail: Option<String>,
    },
    /// Writes a query and reads its reply.
    Ask(Question),
    /// Discards incoming bytes until there is silence.
    Drain {
        /// Length of the silence that ends the move.
        silence: Span,
        /// Time after which the move fails.
        limit: Span,
    },
    /// Ends the program: the values of its queries, or the reason why there are none.
    Done(Result<Vec<Reply>, Failure>),
}

/// A query for the caller to carry out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Question {
    /// Text of the query for messages.
    pub command: String,
    /// Bytes to write; empty to read only one more reply.
    pub bytes: Vec<u8>,
    /// Form that tells where the reply ends.
    pub form: Form,
    /// Time from the first byte written to the last one read.
    pub limit: Span,
    /// Line that must follow the reply.
    pub tail: Option<String>,
    /// True when bytes before the query or after the reply are a failure; false when the caller discards them.
    pub strict: bool,
}

impl Question {
    /// Returns a query whose reply must come alone and, behind an adapter, with the proof of its address.
    pub fn new(framing: Framing, command: &str, form: Form, limit: Span) -> Self {
        let (bytes, tail) = framing.proven(framing.ask(command, limit));
        Self {
            command: command.to_owned(),
            bytes,
            form,
            limit,
            tail,
            strict: true,
        }
    }
}

/// Phase of a resynchronisation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    Open,
    Adapter,
    Clear,
    Remote,
    Drain,
    Mark(u8),
    Echo {
        round: u8,
        discarded: u8,
    },
    Identity {
        round: u8,
        discarded: u8,
    },
    /// Reads the event register; must come before `*CLS`, which would clear the sign of a loss of power.
    Events,
    ClearStatus,
}

impl Phase {
    /// Returns the failure of a search. When the search has already discarded replies, a timeout means that none of
    /// them was the expected one, and not that the instrument is silent.
    fn explained(self, failure: Failure) -> Failure {
        match (self, failure) {
            (
                Self::Echo { discarded: 1.., .. } | Self::Identity { discarded: 1.., .. },
                Failure::Timeout { command, .. },
            ) => Failure::OutOfStep { command },
            (_, failure) => failure,
        }
    }
}

/// Greatest number of replies that a search for an echo discards.
const DISCARDED: u8 = 32;

#[derive(Debug)]
enum Doing {
    Nothing,
    Sync { attempt: u8, phase: Phase },
    SetUp(Run),
    Program(Run),
}

/// State of a link. A program runs only in step; after any doubt the next program begins with a resynchronisation.
#[derive(Debug)]
pub struct Session {
    settings: LinkSettings,
    doing: Doing,
    /// Program that waits for the resynchronisation and the set-up.
    waiting: Program,
    /// True when this program also waits for the set-up.
    wants_set_up: bool,
    /// True when the set-up succeeded after the last resynchronisation.
    is_set_up: bool,
    in_step: bool,
    is_open: bool,
    generation: u64,
    backoff: Span,
    nonce: Nonce,
    /// Identity of the instrument that answered first; later ones must be the same.
    bound: Option<String>,
    /// True when the link has already reported the loss of power that the event register will show.
    power_reported: bool,
    /// True when the program must end with [`Failure::PowerCycled`] although the resynchronisation succeeded.
    lost_power: bool,
    /// The last reply; a new reply that equals it may be its copy.
    previous: Option<Raw>,
}

impl Session {
    /// Creates the session of a closed link; `seed` selects the sequence of numbers that prove that the link is in
    /// step.
    pub fn new(settings: LinkSettings, seed: u64) -> Self {
        let backoff = Span(0);
        Self {
            settings,
            doing: Doing::Nothing,
            waiting: Program::default(),
            wants_set_up: true,
            is_set_up: false,
            in_step: false,
            is_open: false,
            generation: 0,
            backoff,
            nonce: Nonce::new(seed),
            bound: None,
            power_reported: true,
            lost_power: false,
            previous: None,
        }
    }

    /// Returns the settings.
    pub fn settings(&self) -> &LinkSettings {
        &self.settings
    }

    /// Returns the number of resynchronisations so far; replies of an earlier generation are never delivered.
    pub fn generation(&self) -> u64 {
        self.generation
    }

    /// Returns true when the next program needs no resynchronisation.
    pub fn is_in_step(&self) -> bool {
        self.in_step
    }

    /// Returns the identity of the instrument; `None` before the first resynchronisation.
    pub fn identity(&self) -> Option<&str> {
        self.bound.as_deref()
    }

    /// Makes the next program begin with a resynchronisation, because something failed outside of a program.
    pub fn doubt(&mut self) {
        self.in_step = false;
    }

    /// Begins a program. After doubt, and when the previous program was abandoned, a resynchronisation comes first.
    pub fn start(&mut self, program: Program) -> Move {
        self.begin(program, true)
    }

    /// Begins a program that makes the instrument safe. After doubt it leaves out the set-up, which may be what fails,
    /// and connects at once, however often the link has failed before.
    pub fn start_safe(&mut self, program: Program) -> Move {
        self.backoff = Span(0);
        self.begin(program, false)
    }

    fn begin(&mut self, program: Program, wants_set_up: bool) -> Move {
        self.in_step &= matches!(self.doing, Doing::Nothing);
        if self.in_step {
            return self.enter(Doing::Program(Run::new(program)));
        }
        (self.waiting, self.wants_set_up) = (program, wants_set_up);
        self.sync(0)
    }

    /// Takes the outcome of the last move, for a successful query with its reply; returns the next move.
    pub fn next(&mut self, outcome: Result<Option<Raw>, Failure>) -> Move {
        if let Err(Failure::Disconnected { .. }) = &outcome {
            self.is_open = false;
        }
        match mem::replace(&mut self.doing, Doing::Nothing) {
            Doing::Nothing => Move::Done(outcome.map(|_| Vec::new())),
            Doing::Sync { attempt, phase } => {
                let outcome = outcome.map_err(|failure| phase.explained(failure));
                let next = outcome.and_then(|raw| self.after(phase, raw.as_ref()));
                self.synced(attempt, next)
            }
            Doing::SetUp(mut run) => match self.advance(&mut run, outcome) {
                None => self.enter(Doing::SetUp(run)),
                // After a failed set-up the state of the instrument is unknown.
                Some(Err(failure)) => self.finish(Err(failure), false),
                Some(Ok(_)) => {
                    self.is_set_up = true;
                    match mem::take(&mut self.lost_power) {
                        true => self.finish(Err(Failure::PowerCycled), true),
                        false => self.enter_waiting(),
                    }
                }
            },
            Doing::Program(mut run) => match self.advance(&mut run, outcome) {
                None => self.enter(Doing::Program(run)),
                Some(result) => {
                    let doubt = result.as_ref().err().is_some_and(Failure::is_doubt);
                    self.finish(result, !doubt && self.is_set_up)
                }
            },
        }
    }

    fn finish(&mut self, result: Result<Vec<Reply>, Failure>, in_step: bool) -> Move {
        self.waiting = Program::default();
        self.in_step = in_step;
        Move::Done(result)
    }

    fn enter_waiting(&mut self) -> Move {
        let program = mem::take(&mut self.waiting);
        self.enter(Doing::Program(Run::new(program)))
    }

    /// Sets the present point and returns its move.
    fn enter(&mut self, doing: Doing) -> Move {
        let next = match &doing {
            Doing::Nothing => Move::Done(Ok(Vec::new())),
            Doing::Sync { phase, .. } => self.sync_move(*phase),
            Doing::SetUp(run) | Doing::Program(run) => run.next_move(&self.settings, &self.nonce),
        };
        self.doing = doing;
        next
    }

    fn sync(&mut self, attempt: u8) -> Move {
        (self.in_step, self.is_set_up) = (false, false);
        self.generation += 1;
        self.previous = None;
        // A serial port stays open in the first attempt; when that fails, the port itself may be the cause.
        let phase = match self.is_open && !self.settings.reopen && attempt == 0 {
            true => Phase::Adapter,
            false => Phase::Open,
        };
        self.enter(Doing::Sync { attempt, phase })
    }

    fn synced(&mut self, attempt: u8, next: Result<Option<Phase>, Failure>) -> Move {
        match next {
            Ok(Some(phase)) => self.enter(Doing::Sync { attempt, phase }),
            Ok(None) => {
                self.backoff = Span(0);
                match self.wants_set_up {
                    true => self.enter(Doing::SetUp(Run::new(self.settings.set_up.clone()))),
                    false => self.enter_waiting(),
                }
            }
            Err(failure @ Failure::Identity { .. }) => self.finish(Err(failure), false),
            Err(failure) => {
                let grown = (self.backoff + self.backoff).max(self.settings.backoff_first);
                self.backoff = grown.min(self.settings.backoff_longest);
                let attempts = attempt + 1;
                if attempts >= self.settings.attempts || matches!(failure, Failure::Overdue { .. })
                {
                    let last = Box::new(failure);
                    return self.finish(Err(Failure::Down { attempts, last }), false);
                }
                self.sync(attempts)
            }
        }
    }

    fn sync_move(&self, phase: Phase) -> Move {
        let (framing, limit) = (self.settings.framing, self.settings.limit);
        let bytes = |bytes| Move::Send {
            bytes,
            limit,
            tail: None,
        };
        let send = |command: &str| bytes(framing.send(command));
        match phase {
            Phase::Open => Move::Open {
                after: self.backoff,
                limit: self.settings.open_limit,
            },
            Phase::Adapter => bytes(framing.set_up()),
            Phase::Clear => bytes(framing.clear()),
            Phase::Remote => self
                .settings
                .remote
                .as_deref()
                .map_or(bytes(Vec::new()), send),
            Phase::Drain => Move::Drain {
                silence: self.drain(),
                limit: limit + limit,
            },
            Phase::ClearStatus => send("*CLS"),
            Phase::Mark(_) => send(&format!("*ESE {}", self.nonce.current())),
            Phase::Echo { discarded, .. } => self.search("*ESE?", discarded),
            Phase::Identity { discarded, .. } => self.search("*IDN?", discarded),
            Phase::Events => self.search("*ESR?", 0),
        }
    }

    fn drain(&self) -> Span {
        match self.settings.echo {
            Echo::Ese => self.settings.silence,
            Echo::Identity => self.settings.limit,
        }
    }

    /// Returns a move that sends the query or, when the search has already discarded a reply, only reads the next
    /// reply.
    fn search(&self, command: &str, discarded: u8) -> Move {
        let limit = self.settings.limit;
        let bytes = match discarded {
            0 => self.settings.framing.ask(command, limit),
            _ => Vec::new(),
        };
        let (command, form) = (command.to_owned(), Form::Line);
        Move::Ask(Question {
            command,
            bytes,
            form,
            limit,
            tail: None,
            strict: false,
        })
    }

    /// Returns the phase after this one; `None` when the link is in step.
    fn after(&mut self, phase: Phase, raw: Option<&Raw>) -> Result<Option<Phase>, Failure> {
        let line = raw.and_then(|it| it.text().ok()).unwrap_or_default();
        let again = |discarded: u8, command: &str| match discarded < DISCARDED {
            true => Ok(discarded + 1),
            false => Err(Failure::OutOfStep {
                command: command.to_owned(),
            }),
        };
        let next = match phase {
            Phase::Open => {
                self.is_open = true;
                Phase::Adapter
            }
            Phase::Adapter => Phase::Clear,
            Phase::Clear => Phase::Remote,
            Phase::Remote => Phase::Drain,
            Phase::Drain if self.settings.echo == Echo::Identity => Phase::Identity {
                round: 0,
                discarded: 0,
            },
            Phase::Drain => self.mark(0),
            Phase::Mark(round) => Phase::Echo {
                round,
                discarded: 0,
            },
            Phase::Echo { round, .. } if line.parse() == Ok(self.nonce.current()) => match round {
                0 => self.mark(1),
                _ => Phase::Identity {
                    round: 1,
                    discarded: 0,
                },
            },
            Phase::Echo { round, discarded } => Phase::Echo {
                round,
                discarded: again(discarded, "*ESE?")?,
            },
            Phase::Identity { round, discarded } if !self.is_identity(line) => {
                let is_one = line.matches(',').count() >= 2;
                // After an echo no older reply can come.
                let is_due = self.settings.echo == Echo::Ese || self.bound.is_none();
                if is_one && (is_due || discarded == DISCARDED) {
                    return Err(self.other_instrument(line));
                }
                Phase::Identity {
                    round,
                    discarded: again(discarded, "*IDN?")?,
                }
            }
            Phase::Identity { round, .. } => {
                self.bound.get_or_insert_with(|| line.to_owned());
                match round {
                    0 => Phase::Identity {
                        round: 1,
                        discarded: 0,
                    },
                    _ => Phase::Events,
                }
            }
            Phase::Events => {
                self.lost_power |= events(raw)?.power_on() && !self.power_reported;
                self.power_reported = false;
                Phase::ClearStatus
            }
            Phase::ClearStatus => return Ok(None),
        };
        Ok(Some(next))
    }

    fn mark(&mut self, round: u8) -> Phase {
        self.nonce.advance();
        Phase::Mark(round)
    }

    fn is_identity(&self, line: &str) -> bool {
        if let Some(bound) = &self.bound {
            return bound == line;
        }
        let found = Identity::read(line);
        let expected = self.settings.identity.as_ref();
        expected.is_none_or(|it| it.accepts(&found)) && !found.model.is_empty()
    }

    fn other_instrument(&self, line: &str) -> Failure {
        let expected = self.settings.identity.as_ref();
        let expected = expected.map(ToString::to_string);
        let bound = self.bound.as_ref().map(|it| format!("{it:?}"));
        Failure::Identity {
            found: line.to_owned(),
            expected: bound
                .or(expected)
                .unwrap_or_else(|| "maker, model, serial number".to_owned()),
        }
    }

    /// Takes the outcome of a move of a run; returns the result when the run ends.
    fn advance(
        &mut self,
        run: &mut Run,
        outcome: Result<Option<Raw>, Failure>,
    ) -> Option<Result<Vec<Reply>, Failure>> {
        let raw = outcome.as_ref().ok().and_then(Option::as_ref);
        // Behind an adapter, after a lost reply, the line that proves the address may stand in the place of the reply.
        let copy = raw.is_some_and(|it| {
            self.previous.as_ref() == Some(it) || self.settings.framing.is_proof(it)
        });
        if let Ok(Some(raw)) = &outcome {
            self.previous = Some(raw.clone());
        }
        let echo = match self.settings.echo {
            Echo::Ese => self.nonce.current().to_string(),
            Echo::Identity => self.bound.clone().unwrap_or_default(),
        };
        let result = run.advance(&self.settings, &echo, outcome, copy);
        if run.at == At::Mark {
            self.nonce.advance();
        }
        self.power_reported |= matches!(result, Some(Err(Failure::PowerCycled)));
        debug_assert!(result.is_none() || run.at == At::End, "a result ends a run");
        result
    }
}
