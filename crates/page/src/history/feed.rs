//! Answers from the file to the client, one part at a time: memory does not grow with the answer.
//!
//! The reader fills pieces of some 32 kB and hands them over; a client that takes none for
//! [`PATIENCE`] is dropped, so that no reader stays in the file for ever. An error after the first
//! piece cuts the answer off: its last chunk never comes, which no client takes for whole.

use axum::body::{Body, Bytes};
use futures_util::stream;
use history::{Archive, Filter};
use std::io::{self, Write};
use std::time::Duration;
use tokio::runtime::Handle;
use tokio::sync::mpsc::{self, Sender};
use tokio::task::spawn_blocking;
use tokio::time::timeout;

/// How long a client may take nothing.
const PATIENCE: Duration = Duration::from_secs(10);
/// A piece is handed over once it is this long.
const PIECE: usize = 32 * 1024;

type Piece = io::Result<Bytes>;

/// What `write` writes, from a thread of its own that keeps the archive and its place to the end.
pub(super) fn streamed(
    (archive, place): (Archive, impl Send + 'static),
    write: impl FnOnce(&Archive, &mut Pieces) -> io::Result<()> + Send + 'static,
) -> Body {
    let (sender, receiver) = mpsc::channel::<Piece>(2);
    let runtime = Handle::current();
    spawn_blocking(move || {
        let mut out = Pieces::new(runtime, sender);
        if let Err(error) = write(&archive, &mut out).and_then(|()| out.hand_over()) {
            // Nobody left to tell when the client has gone.
            let _ = out.send(Err(error));
        }
        drop(place);
    });
    Body::from_stream(stream::unfold(receiver, |mut receiver| async move {
        let piece = receiver.recv().await?;
        Some((piece, receiver))
    }))
}

/// The parts that `filter` leaves, as a JSON array.
pub(super) fn parts(archive: &Archive, filter: &Filter, out: &mut Pieces) -> io::Result<()> {
    let mut lead: &[u8] = b"[\n";
    let all = archive.each(filter, |part| {
        out.write_all(lead)?;
        lead = b",\n";
        serde_json::to_writer(&mut *out, &part).map_err(io::Error::from)
    });
    all.map_err(io::Error::other)??;
    out.write_all(if lead == b"[\n" { b"[]\n" } else { b"\n]\n" })
}

/// The reader's end.
pub(super) struct Pieces {
    text: Vec<u8>,
    runtime: Handle,
    sender: Sender<Piece>,
}

impl Pieces {
    fn new(runtime: Handle, sender: Sender<Piece>) -> Self {
        let text = Vec::with_capacity(PIECE + 4096);
        Self {
            text,
            runtime,
            sender,
        }
    }

    fn hand_over(&mut self) -> io::Result<()> {
        let piece = Bytes::from(std::mem::take(&mut self.text));
        self.send(Ok(piece))
    }

    fn send(&self, piece: Piece) -> io::Result<()> {
        let sent = self.runtime.block_on(async {
            // The timer is made inside, where the runtime is known.
            timeout(PATIENCE, self.sender.send(piece)).await
        });
        match sent {
            Ok(Ok(())) => Ok(()),
            Ok(Err(_)) => Err(io::ErrorKind::BrokenPipe.into()),
            Err(_) => Err(io::ErrorKind::TimedOut.into()),
        }
    }
}

impl Write for Pieces {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.text.extend_from_slice(bytes);
        if self.text.len() >= PIECE {
            self.hand_over()?;
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
