//! The bytes of one exchange: out, in until CR or the deadline, and silence.

use super::trace::Direction;
use super::{LineLog, Pace};
use dcon::{Command, FRAME_LIMIT};
use std::future::poll_fn;
use std::io;
use std::pin::{Pin, pin};
use std::task::Poll;
use tokio::io::{AsyncRead, AsyncReadExt, AsyncWrite, AsyncWriteExt, ReadBuf};
use tokio::time::Sleep;
use units::{RigTime, Span};

/// A frame as it comes in, possibly in pieces.
#[derive(Debug)]
pub(super) struct Frame {
    bytes: [u8; FRAME_LIMIT],
    length: usize,
}

/// How listening for a reply ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Heard {
    /// Up to its CR and nothing behind.
    Whole,
    /// A CR, and more behind it.
    More,
    /// More characters than any frame has.
    TooLong,
    /// The deadline, first.
    Nothing,
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
        debug_assert!(self.length <= FRAME_LIMIT, "a frame beyond its end");
        &self.bytes[..self.length]
    }

    /// Takes a piece in; none while the frame is not at an end.
    fn push(&mut self, piece: &[u8]) -> Option<Heard> {
        for (at, byte) in piece.iter().enumerate() {
            let Some(slot) = self.bytes.get_mut(self.length) else {
                return Some(Heard::TooLong);
            };
            *slot = *byte;
            self.length += 1;
            if *byte == b'\r' {
                return Some(if at + 1 == piece.len() {
                    Heard::Whole
                } else {
                    Heard::More
                });
            }
        }
        None
    }
}

/// What came of asking a module to name itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Named {
    /// The module has answered, and nothing came behind.
    pub(super) by_module: bool,
    /// Something else was heard.
    pub(super) strays: bool,
    /// When the last character was heard; when it was asked, if none.
    pub(super) last_heard: RigTime,
}

/// How waiting for silence ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quiet {
    /// Nothing was heard for long enough.
    Silent,
    /// The module has said who it is; what came before is accounted for.
    Named,
    /// Somebody talks on.
    Noisy,
}

/// A port with the clock and the log that go with it.
pub(super) struct Exchange<'a, P> {
    pub(super) port: &'a mut P,
    pub(super) pace: Pace,
    pub(super) log: &'a LineLog,
}

impl<P: AsyncRead + AsyncWrite + Unpin> Exchange<'_, P> {
    /// Writes `request` and listens until a frame is whole or `deadline` has come. What was heard is in `frame`.
    pub(super) async fn ask(
        &mut self,
        request: &[u8],
        deadline: RigTime,
        frame: &mut Frame,
    ) -> io::Result<Heard> {
        assert!(!request.is_empty(), "an empty request");
        frame.clear();
        let mut timer = pin!(self.pace.sleep(deadline));
        if !self.write(request, timer.as_mut()).await? {
            return Ok(Heard::Nothing);
        }
        let mut piece = [0; 2 * FRAME_LIMIT];
        let heard = loop {
            let Some(count) = self.piece(&mut piece, timer.as_mut()).await? else {
                break Heard::Nothing;
            };
            if let Some(heard) = frame.push(&piece[..count]) {
                break heard;
            }
        };
        if !frame.bytes().is_empty() {
            self.note(Direction::Heard, frame.bytes());
        }
        Ok(heard)
    }

    /// Sends `question`, whose reply names its module, and listens until `in_step` says of a frame that it is the one
    /// waited for, or `deadline`.
    pub(super) async fn name(
        &mut self,
        question: &Command,
        with_checksum: bool,
        deadline: RigTime,
        mut in_step: impl FnMut(&[u8]) -> bool,
    ) -> io::Result<Named> {
        assert!(question.address().is_some(), "nobody to name itself");
        let mut request = Vec::with_capacity(8);
        question.encode(with_checksum, &mut request);
        let mut named = Named {
            by_module: false,
            strays: false,
            last_heard: self.pace.now(),
        };
        let mut timer = pin!(self.pace.sleep(deadline));
        if !self.write(&request, timer.as_mut()).await? {
            return Ok(named);
        }
        let mut frame = Frame::new();
        let mut piece = [0; 2 * FRAME_LIMIT];
        while !named.by_module {
            let Some(count) = self.piece(&mut piece, timer.as_mut()).await? else {
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
                    Direction::Heard
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

    /// Writes and listens to nobody.
    pub(super) async fn tell(&mut self, request: &[u8], deadline: RigTime) -> io::Result<()> {
        let timer = pin!(self.pace.sleep(deadline));
        self.write(request, timer).await.map(|_| ())
    }

    /// False when the port does not take the bytes in time.
    async fn write(&mut self, bytes: &[u8], timer: Pin<&mut Sleep>) -> io::Result<bool> {
        self.note(Direction::Sent, bytes);
        tokio::select! {
            biased;
            written = self.port.write_all(bytes) => written.map(|()| true),
            () = timer => Ok(false),
        }
    }

    /// Characters as they come; none when `timer` has fired and nothing is waiting.
    ///
    /// A host that was kept from running wakes with its timer fired *and* the reply in the buffer of the port. Such a
    /// module was not silent: before it is given up the reactor is asked once more, which takes no time.
    async fn piece(
        &mut self,
        piece: &mut [u8],
        timer: Pin<&mut Sleep>,
    ) -> io::Result<Option<usize>> {
        let in_time = tokio::select! {
            biased;
            count = self.port.read(piece) => Some(count?),
            () = timer => None,
        };
        let count = match in_time {
            Some(count) => Some(count),
            None => {
                tokio::task::yield_now().await;
                self.read_now(piece).await?
            }
        };
        assert!(count.is_none_or(|count| count <= piece.len()), "overrun");
        match count {
            Some(0) => Err(io::ErrorKind::UnexpectedEof.into()),
            count => Ok(count),
        }
    }

    /// Throws away what has come in, without waiting for more. Returns the number of bytes.
    pub(super) async fn discard(&mut self) -> io::Result<usize> {
        let mut piece = [0; 2 * FRAME_LIMIT];
        let mut total = 0;
        // A babbling neighbour could fill the buffer as fast as it is emptied.
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

    /// None when nothing is waiting.
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
        // Outside the cooperative budget: there, pending may mean no more than "let others go first".
        tokio::task::unconstrained(read).await
    }

    /// Waits until nothing has been heard for `silence` since `last_heard`, or `in_step` says of a frame that it is the
    /// one waited for, until `limit` at the latest.
    pub(super) async fn silence(
        &mut self,
        silence: Span,
        last_heard: RigTime,
        limit: RigTime,
        mut in_step: impl FnMut(&[u8]) -> bool,
    ) -> io::Result<Quiet> {
        let mut frame = Frame::new();
        let mut piece = [0; 2 * FRAME_LIMIT];
        let mut until = last_heard + silence;
        while until <= limit {
            let timer = pin!(self.pace.sleep(until));
            let Some(count) = self.piece(&mut piece, timer).await? else {
                return Ok(Quiet::Silent);
            };
            self.note(Direction::Stray, &piece[..count]);
            until = self.pace.now() + silence;
            for byte in &piece[..count] {
                if frame.push(std::slice::from_ref(byte)).is_some() {
                    if in_step(frame.bytes()) {
                        return Ok(Quiet::Named);
                    }
                    frame.clear();
                }
            }
        }
        Ok(Quiet::Noisy)
    }

    fn note(&self, direction: Direction, bytes: &[u8]) {
        self.log
            .records()
            .trace
            .add(self.pace.now(), direction, bytes);
    }
}
