//! The bytes of one exchange: out, in until CR or the deadline, and silence.

use super::trace::Direction;
use super::{LineLog, Pace};
use crate::dcon::FRAME_LIMIT;
use crate::units::{RigTime, Span};
use std::future::poll_fn;
use std::io;
use std::pin::Pin;
use std::task::Poll;
use tokio::io::{AsyncRead, AsyncReadExt, AsyncWrite, AsyncWriteExt, ReadBuf};
use tokio::time::Sleep;

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
        frame.clear();
        let timer = self.pace.sleep(deadline);
        tokio::pin!(timer);
        if !self.write(request, timer.as_mut()).await? {
            return Ok(Heard::Nothing);
        }
        let mut piece = [0; 2 * FRAME_LIMIT];
        let heard = loop {
            tokio::select! {
                biased;
                count = self.port.read(&mut piece) => match count? {
                    0 => return Err(io::ErrorKind::UnexpectedEof.into()),
                    count => if let Some(heard) = frame.push(&piece[..count]) { break heard },
                },
                () = timer.as_mut() => break Heard::Nothing,
            }
        };
        if !frame.bytes().is_empty() {
            self.note(Direction::Heard, frame.bytes());
        }
        Ok(heard)
    }

    /// Writes and listens to nobody.
    pub(super) async fn tell(&mut self, request: &[u8], deadline: RigTime) -> io::Result<()> {
        let timer = self.pace.sleep(deadline);
        tokio::pin!(timer);
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

    /// Waits until nothing has been heard for `silence`; false when that has not come about before `limit`.
    pub(super) async fn silence(&mut self, silence: Span, limit: RigTime) -> io::Result<bool> {
        let mut piece = [0; 2 * FRAME_LIMIT];
        let mut until = self.pace.now() + silence;
        while until <= limit {
            tokio::select! {
                biased;
                count = self.port.read(&mut piece) => match count? {
                    0 => return Err(io::ErrorKind::UnexpectedEof.into()),
                    count => {
                        self.note(Direction::Stray, &piece[..count]);
                        until = self.pace.now() + silence;
                    }
                },
                () = self.pace.sleep(until) => return Ok(true),
            }
        }
        Ok(false)
    }

    fn note(&self, direction: Direction, bytes: &[u8]) {
        self.log
            .records()
            .trace
            .add(self.pace.now(), direction, bytes);
    }
}
