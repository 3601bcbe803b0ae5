//! Links to SCPI instruments: a link carries out the moves of its [`Session`] (open, write, ask, drain) on a stream,
//! with a deadline for each.
//!
//! The crate [`scpi`] proves that a reply belongs to its query; a link adds a clock, a stream and a log of the traffic.

mod log;
mod message;
mod task;

use super::{Direction, OpenPort, Pace, Port, Timer, escaped, open_serial_with};
pub use log::{LinkHealth, LinkLog, Traffic};
pub use message::message;
use scpi::{
    Failure, Flow, Form, LinkAddress, LinkSettings, Move, Program, Question, Raw, Reader, Reply,
    ReplyError, Session, Transport,
};
use std::fmt::Display;
use std::future::ready;
use std::io;
pub use task::{ProgramAnswer, ProgramRequest, Start, serve};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio_serial::FlowControl;
use units::{RigTime, Span};

/// How a link opens its stream, at the start and again when the session asks for a new connection.
pub enum Opener {
    /// At an address.
    At(LinkAddress, Flow),
    /// By a function, for streams in memory.
    Streams(OpenPort),
}

/// A link to one instrument. One program runs at a time.
pub struct Link {
    session: Session,
    opener: Opener,
    stream: Option<Box<dyn Port>>,
    reader: Reader,
    pace: Pace,
    timer: Timer,
    log: LinkLog,
    programs: u64,
}

impl Link {
    /// Creates a closed link; the first program opens it. `seed` should differ at each start of the program.
    pub fn new(opener: Opener, settings: LinkSettings, pace: Pace, seed: u64) -> Self {
        Self {
            session: Session::new(settings, seed),
            opener,
            stream: None,
            reader: Reader::default(),
            pace,
            timer: Timer::new(pace),
            log: LinkLog::default(),
            programs: 0,
        }
    }

    /// Returns a handle to the traffic.
    pub fn log(&self) -> LinkLog {
        self.log.clone()
    }

    /// Returns the state of the link.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// Runs a program.
    ///
    /// # Errors
    /// Fails with the first reason why the values are not certain. After a failure that leaves doubt
    /// ([`Failure::is_doubt`]) the next program begins with a resynchronisation, and so it does after a program whose
    /// future was dropped.
    pub async fn run(&mut self, program: Program) -> Result<Vec<Reply>, Failure> {
        self.carry_out(program, Session::start).await
    }

    /// Runs a program that makes the instrument safe. After doubt it runs without the set-up, because the set-up may be
    /// what fails.
    ///
    /// # Errors
    /// Fails as [`Link::run`] does.
    pub async fn make_safe(&mut self, program: Program) -> Result<Vec<Reply>, Failure> {
        self.carry_out(program, Session::start_safe).await
    }

    async fn carry_out(
        &mut self,
        program: Program,
        start: fn(&mut Session, Program) -> Move,
    ) -> Result<Vec<Reply>, Failure> {
        self.programs += 1;
        self.log.write(|it| it.begun());
        let outcome = self.steps(program, start).await;
        let failure = outcome.as_ref().err().map(Failure::code);
        let identity = self.session.identity().map(str::to_owned);
        self.log.write(move |it| it.ended(failure, identity));
        outcome
    }

    async fn steps(
        &mut self,
        program: Program,
        start: fn(&mut Session, Program) -> Move,
    ) -> Result<Vec<Reply>, Failure> {
        let limit = self.session.settings().longest(&program);
        let deadline = self.pace.now() + limit;
        let mut next = start(&mut self.session, program);
        loop {
            let outcome = match next {
                Move::Done(result) => return result,
                _ if self.pace.now() >= deadline => Err(Failure::Overdue { limit }),
                Move::Open { after, limit } => self.open(after, limit, deadline).await,
                Move::Send { bytes, limit, tail } => self.send(bytes, limit, tail.as_deref()).await,
                Move::Ask(question) => self.ask(&question).await.map(Some),
                Move::Drain { silence, limit } => self.drain(silence, limit).await,
            };
            next = self.session.next(outcome);
        }
    }

    /// Opens the stream if needed, writes a message and reads its reply, without proof and without resynchronisation;
    /// for tools that show the behaviour of an instrument. Without `form` it expects no reply.
    ///
    /// # Errors
    /// Fails as [`Link::run`] does; the next program then begins with a resynchronisation.
    pub async fn exchange(
        &mut self,
        command: &str,
        form: Option<Form>,
    ) -> Result<Option<Raw>, Failure> {
        self.programs += 1;
        let outcome = self.unproven(command, form).await;
        if outcome.is_err() {
            self.session.doubt();
        }
        outcome
    }

    async fn unproven(
        &mut self,
        command: &str,
        form: Option<Form>,
    ) -> Result<Option<Raw>, Failure> {
        let (framing, limit) = (
            self.session.settings().framing,
            self.session.settings().limit,
        );
        if self.stream.is_none() {
            let open_limit = self.session.settings().open_limit;
            let deadline = self.pace.now() + open_limit;
            self.open(Span(0), open_limit, deadline).await?;
            self.send(framing.set_up(), limit, None).await?;
        }
        let Some(form) = form else {
            let (bytes, tail) = framing.proven(framing.send(command));
            return self.send(bytes, limit, tail.as_deref()).await;
        };
        let question = Question::new(framing, command, form, limit);
        self.ask(&question).await.map(Some)
    }

    async fn open(
        &mut self,
        after: Span,
        limit: Span,
        deadline: RigTime,
    ) -> Result<Option<Raw>, Failure> {
        self.stream = None;
        self.reader.clear();
        let until = self.pace.now() + after;
        self.timer.until(until.min(deadline)).await;
        self.stream = Some(match &mut self.opener {
            Opener::Streams(next) => next().map_err(disconnected)?,
            Opener::At(address, flow) => {
                let until = self.pace.now() + limit;
                tokio::select! {
                    biased;
                    opened = open(&address.transport, *flow) => opened?,
                    () = self.timer.until(until) => {
                        let limit_ms = limit.0 / 1000;
                        return Err(disconnected(format!("{address}: no connection within {limit_ms} ms")));
                    }
                }
            }
        });
        Ok(None)
    }

    /// Writes a message, and reads the line `tail` that must follow.
    async fn send(
        &mut self,
        bytes: Vec<u8>,
        limit: Span,
        tail: Option<&str>,
    ) -> Result<Option<Raw>, Failure> {
        if bytes.is_empty() {
            return Ok(None);
        }
        let Some(tail) = tail else {
            let deadline = self.pace.now() + limit;
            self.write(&bytes, deadline).await?;
            return Ok(None);
        };
        let question = Question {
            command: command(&bytes),
            bytes,
            form: Form::Line,
            limit,
            tail: None,
            strict: true,
        };
        match self.ask(&question).await? {
            Raw::Line(line) if line == tail.as_bytes() => Ok(None),
            Raw::Line(found) | Raw::Block(found) => Err(another_address(&found, tail)),
        }
    }

    async fn ask(&mut self, question: &Question) -> Result<Raw, Failure> {
        let command = || question.command.clone();
        if question.strict && self.strays().await? {
            return Err(Failure::OutOfStep { command: command() });
        }
        let asked_at = self.pace.now();
        let deadline = asked_at + question.limit;
        if !question.bytes.is_empty() {
            self.reader.clear();
            self.write(&question.bytes, deadline).await?;
        }
        let malformed = |reason| Failure::Malformed {
            command: command(),
            reason,
        };
        let (form, tail) = (question.form, question.tail.as_deref());
        let found = loop {
            if let Some(found) = self.reader.take_with_tail(form, tail).map_err(malformed)? {
                let latency = self.pace.now().since(asked_at);
                self.log.write(move |it| it.answered(latency));
                break found;
            }
            let Some(piece) = self.piece(deadline).await? else {
                return Err(self.silence(question));
            };
            self.note(Direction::Received, piece.bytes());
            self.reader.push(piece.bytes(), form).map_err(malformed)?;
        };
        let raw = found.map_err(|line| another_address(&line, tail.unwrap_or_default()))?;
        match question.strict && self.reader.waiting() > 0 {
            true => Err(malformed(ReplyError::More)),
            false => Ok(raw),
        }
    }

    /// Returns the failure that explains why no reply arrived in time.
    fn silence(&mut self, question: &Question) -> Failure {
        let command = question.command.clone();
        let alone = self.reader.without_tail().and_then(|it| it.text().ok());
        // When the reply never came, the address line of an adapter stands alone.
        let address = alone.filter(|it| it.parse::<u8>().is_ok_and(|it| it <= 30));
        if let (Some(found), Some(expected)) = (address, question.tail.as_deref())
            && found != expected
        {
            return another_address(found.as_bytes(), expected);
        }
        match self.reader.clear() {
            0 => Failure::Timeout {
                command,
                limit: question.limit,
            },
            received => Failure::Malformed {
                command,
                reason: ReplyError::Incomplete { received },
            },
        }
    }

    /// Returns true when unrequested bytes wait; discards them.
    async fn strays(&mut self) -> Result<bool, Failure> {
        let waiting = self.reader.clear() > 0;
        let now = self.pace.now();
        let piece = self.piece(now).await?;
        if let Some(piece) = &piece {
            self.note(Direction::Stray, piece.bytes());
        }
        Ok(waiting || piece.is_some())
    }

    async fn drain(&mut self, silence: Span, limit: Span) -> Result<Option<Raw>, Failure> {
        self.reader.clear();
        let deadline = self.pace.now() + limit;
        loop {
            let now = self.pace.now();
            if now >= deadline {
                return Err(Failure::NeverSilent);
            }
            match self.piece(now + silence).await? {
                Some(piece) => self.note(Direction::Stray, piece.bytes()),
                None => return Ok(None),
            }
        }
    }

    /// Writes a message. A message that leaves only in part ends the connection, so that nothing can follow it.
    async fn write(&mut self, bytes: &[u8], deadline: RigTime) -> Result<(), Failure> {
        self.note(Direction::Sent, bytes);
        let stream = self.stream.as_mut().ok_or_else(closed)?;
        let written = tokio::select! {
            biased;
            written = stream.write_all(bytes) => written,
            () = self.timer.until(deadline) => Err(io::ErrorKind::TimedOut.into()),
        };
        written.map_err(|error| self.broken(&error))
    }

    /// Reads the bytes that have arrived or arrive by `deadline`; `None` when there are none.
    async fn piece(&mut self, deadline: RigTime) -> Result<Option<Piece>, Failure> {
        let mut piece = Piece {
            bytes: [0; 2048],
            length: 0,
        };
        let stream = self.stream.as_mut().ok_or_else(closed)?;
        let read = if self.pace.now() >= deadline {
            tokio::select! {
                biased;
                read = stream.read(&mut piece.bytes) => Some(read),
                () = ready(()) => None,
            }
        } else {
            tokio::select! {
                biased;
                read = stream.read(&mut piece.bytes) => Some(read),
                () = self.timer.until(deadline) => None,
            }
        };
        match read {
            None => Ok(None),
            Some(Ok(0)) => {
                self.stream = None;
                Err(closed())
            }
            Some(Ok(length)) => {
                piece.length = length;
                Ok(Some(piece))
            }
            Some(Err(error)) => Err(self.broken(&error)),
        }
    }

    fn broken(&mut self, error: &io::Error) -> Failure {
        self.stream = None;
        disconnected(error.kind())
    }

    fn note(&self, direction: Direction, bytes: &[u8]) {
        let at = self.pace.now();
        let entry = Traffic::new(
            at,
            (self.programs, self.session.generation()),
            direction,
            bytes,
        );
        self.log.write(|ring| ring.add(entry));
    }
}

fn disconnected(reason: impl Display) -> Failure {
    Failure::Disconnected {
        reason: reason.to_string(),
    }
}

fn another_address(found: &[u8], expected: &str) -> Failure {
    Failure::AdapterAddress {
        found: escaped(found),
        expected: expected.to_owned(),
    }
}

/// Returns the command in a message, without the lines for an adapter.
fn command(message: &[u8]) -> String {
    let text = String::from_utf8_lossy(message);
    let own = text.lines().find(|line| !line.starts_with("++"));
    own.unwrap_or_default().to_owned()
}

fn closed() -> Failure {
    disconnected("the instrument or its adapter has closed the connection")
}

/// Bytes that arrived together.
struct Piece {
    bytes: [u8; 2048],
    length: usize,
}

impl Piece {
    fn bytes(&self) -> &[u8] {
        &self.bytes[..self.length]
    }
}

async fn open(transport: &Transport, flow: Flow) -> Result<Box<dyn Port>, Failure> {
    match transport {
        Transport::Tcp { host, port } => {
            let named = |error: io::Error| disconnected(format!("{host}:{port}: {}", error.kind()));
            let host = host.trim_start_matches('[').trim_end_matches(']');
            let stream = TcpStream::connect((host, *port)).await.map_err(named)?;
            // A query is one small message; with Nagle's algorithm it might wait for the acknowledgement of the
            // previous one.
            stream.set_nodelay(true).map_err(named)?;
            Ok(Box::new(stream))
        }
        Transport::Serial { path, baud } => {
            let flow = match flow {
                Flow::None => FlowControl::None,
                Flow::Xon => FlowControl::Software,
                Flow::Rts => FlowControl::Hardware,
            };
            let port = open_serial_with(path, *baud, flow).map_err(disconnected)?;
            Ok(Box::new(port))
        }
    }
}
