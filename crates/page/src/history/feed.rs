//! Streams answers from the history file to the client, one part at a time: memory does not grow with the answer.
//!
//! The reader sends pieces of about 32 kB. It drops a client that takes no piece for [`CLIENT_TIMEOUT`], so that no
//! reader keeps the file open for ever. After an error in the middle the final HTTP chunk is missing, so that the
//! client sees that the answer is incomplete.

use axum::body::{Body, Bytes};
use futures_util::stream;
use history::{Archive, Filter};
use std::io::{self, Write};
use std::time::Duration;
use tokio::runtime::Handle;
use tokio::sync::mpsc::{self, Sender};
use tokio::task::spawn_blocking;
use tokio::time::timeout;

/// Longest time for which a client may take no piece.
const CLIENT_TIMEOUT: Duration = Duration::from_secs(10);
/// Number of bytes that the reader collects before it sends them as a piece.
const PIECE: usize = 32 * 1024;

type Piece = io::Result<Bytes>;

/// Streams the output of `write`, which runs on a blocking thread; the thread keeps the archive and `place`, the permit
/// to read, until the end.
pub(super) fn streamed(
    (archive, place): (Archive, impl Send + 'static),
    write: impl FnOnce(&Archive, &mut Pieces) -> io::Result<()> + Send + 'static,
) -> Body {
    let (sender, receiver) = mpsc::channel::<Piece>(2);
    let runtime = Handle::current();
    spawn_blocking(move || {
        let mut out = Pieces::new(runtime, sender);
        if let Err(error) = write(&archive, &mut out).and_then(|()| out.send_piece()) {
            // Sending fails only when the client has gone.
            let _ = out.send(Err(error));
        }
        drop(place);
    });
    Body::from_stream(stream::unfold(receiver, |mut receiver| async move {
        let piece = receiver.recv().await?;
        Some((piece, receiver))
    }))
}

/// Writes the parts that match `filter` as a JSON array.
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

/// Sending end of a stream; collects bytes into pieces.
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

    fn send_piece(&mut self) -> io::Result<()> {
        let piece = Bytes::from(std::mem::take(&mut self.text));
        self.send(Ok(piece))
    }

    fn send(&self, piece: Piece) -> io::Result<()> {
        let sent = self.runtime.block_on(async {
            // The time-out begins inside the async block, because its timer needs the context of the runtime.
            timeout(CLIENT_TIMEOUT, self.sender.send(piece)).await
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
            self.send_piece()?;
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
