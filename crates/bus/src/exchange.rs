//! Bytes of one exchange: writes a request, reads until CR or the deadline, waits for silence.

use super::trace::{Direction, Entry};
use super::{LineLog, Pace, Port, Timer};
use dcon::{Command, FRAME_LIMIT};
use std::future::poll_fn;
use std::io;
use std::pin::Pin;
use std::task::Poll;
use tokio::io::{AsyncReadExt, AsyncWriteExt, ReadBuf};
use units::{RigTime, Span};

/// Buffer for a frame, which may arrive in several pieces.
#[derive(Debug)]
pub(super) struct Frame {
    bytes: [u8; FRAME_LIMIT],
    length: usize,
}

/// How the wait for a reply ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FrameEnd {
    /// The frame ended with CR, and nothing followed.
    Whole,
    /// The frame ended with CR, and more bytes followed.
    More,
    /// More characters arrived than any frame of the protocol has.
    TooLong,
    /// The deadline passed before the frame ended.
    TimedOut,
}

impl Frame {
    pub(super) fn new() -> Self {
        Self {
            bytes: [0; FRAME_LIMIT],
            length: 0,
        }
    }

    pub(super) fn clear(&mut self) {
        self.length = 0;
    }

    pub(super) fn bytes(&self) -> &[u8] {
        debug_assert!(
            self.length <= FRAME_LIMIT,
            "the frame is longer than its buffer"
        );
        &self.bytes[..self.length]
    }

    /// Appends `piece`; returns how the frame ended, or `None` while it is incomplete.
    fn push(&mut self, piece: &[u8]) -> Option<FrameEnd> {
        for (at, byte) in piece.iter().enumerate() {
            let Some(slot) = self.bytes.get_mut(self.length) else {
                return Some(FrameEnd::TooLong);
            };
            *slot = *byte;
            self.length += 1;
            if *byte == b'\r' {
                return Some(if at + 1 == piece.len() {
                    FrameEnd::Whole
                } else {
                    FrameEnd::More
                });
            }
        }
        None
    }
}

/// Outcome of asking a module for its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Identification {
    /// True when the module answered.
    pub(super) by_module: bool,
    /// True when bytes arrived that are not part of the module's answer.
    pub(super) strays: bool,
    /// Time of the last character received, or of the request when none came.
    pub(super) last_heard: RigTime,
}

/// How the wait for silence ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SilenceEnd {
    /// The line was silent for long enough.
    Silent,
    /// The module answered with its name, so that no further wait for earlier bytes is needed.
    Named,
    /// Bytes kept arriving until the time limit.
    Noisy,
}

/// A port, with the clock, the timer and the log of its line.
pub(super) struct Exchange<'a> {
    pub(super) port: &'a mut dyn Port,
    pub(super) pace: Pace,
    /// Timer that ends the turnaround after each transaction.
    pub(super) timer: &'a Timer,
    pub(super) log: &'a LineLog,
}

impl Exchange<'_> {
    /// Writes `request` and reads until a frame is complete or `deadline` has passed; `frame` then holds the bytes
    /// received.
    pub(super) async fn ask(
        &mut self,
        request: &[u8],
        deadline: RigTime,
        frame: &mut Frame,
    ) -> io::Result<FrameEnd> {
        assert!(!request.is_empty(), "an empty request");
        frame.clear();
        if !self.write(request, deadline).await? {
            return Ok(FrameEnd::TimedOut);
        }
        let mut piece = [0; 2 * FRAME_LIMIT];
        let heard = loop {
            let Some(count) = self.piece(&mut piece, deadline).await? else {
                break FrameEnd::TimedOut;
            };
            if let Some(heard) = frame.push(&piece[..count]) {
                break heard;
            }
        };
        if !frame.bytes().is_empty() {
            self.note(Direction::Received, frame.bytes());
        }
        Ok(heard)
    }

    /// Asks a module for its name and reads until `in_step` accepts a frame or `deadline` has passed.
    pub(super) async fn name(
        &mut self,
        identification: &Command,
        with_checksum: bool,
        deadline: RigTime,
        mut in_step: impl FnMut(&[u8]) -> bool,
    ) -> io::Result<Identification> {
        assert!(
            identification.address().is_some(),
            "a broadcast identifies no module"
        );
        let mut request = Vec::with_capacity(8);
        identification.encode(with_checksum, &mut request);
        let mut named = Identification {
            by_module: false,
            strays: false,
            last_heard: self.pace.now(),
        };
        if !self.write(&request, deadline).await? {
            return Ok(named);
        }
        let mut frame = Frame::new();
        let mut piece = [0; 2 * FRAME_LIMIT];
        while !named.by_module {
            let Some(count) = self.piece(&mut piece, deadline).await? else {
                break;
            };
            named.last_heard = self.pace.now();
            for byte in &piece[..count] {
                named.strays |= named.by_module;
                if frame.push(std::slice::from_ref(byte)).is_none() {
                    continue;
                }
                named.by_module = in_step(frame.bytes());
                named.strays |= !named.by_module;
                let direction = if named.by_module {
                    Direction::Received
                } else {
                    Direction::Stray
                };
                self.note(direction, frame.bytes());
                frame.clear();
            }
        }
        if !frame.bytes().is_empty() {
            named.strays = true;
            self.note(Direction::Stray, frame.bytes());
        }
        Ok(named)
    }

    /// Writes a broadcast, which has no reply.
    pub(super) async fn broadcast(&mut self, request: &[u8], deadline: RigTime) -> io::Result<()> {
        self.write(request, deadline).await.map(|_| ())
    }

    /// Writes `bytes`; returns false when the port has not accepted them before `deadline`.
    async fn write(&mut self, bytes: &[u8], deadline: RigTime) -> io::Result<bool> {
        self.note(Direction::Sent, bytes);
        tokio::select! {
            biased;
            written = self.port.write_all(bytes) => written.map(|()| true),
            () = self.pace.sleep_until(deadline) => Ok(false),
        }
    }

    /// Reads the next bytes; returns `None` when `deadline` has passed and no byte is waiting.
    ///
    /// A busy host may wake late and then find the deadline passed *and* the reply in the buffer of the port. The module
    /// was not silent in this case, so this function polls the reactor once more before it gives up; that poll takes no
    /// time.
    async fn piece(&mut self, piece: &mut [u8], deadline: RigTime) -> io::Result<Option<usize>> {
        let in_time = tokio::select! {
            biased;
            count = self.port.read(piece) => Some(count?),
            () = self.pace.sleep_until(deadline) => None,
        };
        let count = match in_time {
            Some(count) => Some(count),
            None => {
                tokio::task::yield_now().await;
                self.read_now(piece).await?
            }
        };
        assert!(
            count.is_none_or(|count| count <= piece.len()),
            "read beyond the buffer"
        );
        match count {
            Some(0) => Err(io::ErrorKind::UnexpectedEof.into()),
            count => Ok(count),
        }
    }

    /// Discards the bytes received so far without waiting for more; returns their number.
    pub(super) async fn discard(&mut self) -> io::Result<usize> {
        let mut piece = [0; 2 * FRAME_LIMIT];
        let mut total = 0;
        // The loop is bounded, because a module that sends without pause could fill the buffer as fast as the loop
        // empties it.
        for _ in 0..FRAME_LIMIT {
            let count = match self.read_now(&mut piece).await? {
                None => break,
                Some(0) => return Err(io::ErrorKind::UnexpectedEof.into()),
                Some(count) => count,
            };
            self.note(Direction::Stray, &piece[..count]);
            total += count;
        }
        Ok(total)
    }

    /// Reads the bytes that are waiting; returns `None` when there are none.
    async fn read_now(&mut self, piece: &mut [u8]) -> io::Result<Option<usize>> {
        let port = &mut *self.port;
        let read = poll_fn(|context| {
            let mut buffer = ReadBuf::new(piece);
            Poll::Ready(match Pin::new(&mut *port).poll_read(context, &mut buffer) {
                Poll::Ready(Ok(())) => Ok(Some(buffer.filled().len())),
                Poll::Ready(Err(error)) => Err(error),
                Poll::Pending => Ok(None),
            })
        });
        // Reads outside of tokio's cooperative budget, because within it `Pending` may only mean that other tasks run
        // first.
        tokio::task::unconstrained(read).await
    }

    /// Waits until the line has been silent for the time `silence` since `last_heard`, or until `in_step` accepts a
    /// frame; gives up at `limit`.
    pub(super) async fn silence(
        &mut self,
        silence: Span,
        last_heard: RigTime,
        limit: RigTime,
        mut in_step: impl FnMut(&[u8]) -> bool,
    ) -> io::Result<SilenceEnd> {
        let mut frame = Frame::new();
        let mut piece = [0; 2 * FRAME_LIMIT];
        let mut until = last_heard + silence;
        while until <= limit {
            let Some(count) = self.piece(&mut piece, until).await? else {
                return Ok(SilenceEnd::Silent);
            };
            self.note(Direction::Stray, &piece[..count]);
            until = self.pace.now() + silence;
            for byte in &piece[..count] {
                if frame.push(std::slice::from_ref(byte)).is_some() {
                    if in_step(frame.bytes()) {
                        return Ok(SilenceEnd::Named);
                    }
                    frame.clear();
                }
            }
        }
        Ok(SilenceEnd::Noisy)
    }

    fn note(&self, direction: Direction, bytes: &[u8]) {
        let at = self.pace.now();
        for piece in bytes.chunks(FRAME_LIMIT) {
            let entry = Entry::new(at, direction, piece);
            self.log.write(move |it| it.trace.extend(entry));
        }
    }
}
