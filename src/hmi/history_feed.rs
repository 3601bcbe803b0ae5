//! Parts from the file to the client, one at a time: memory does not grow with the answer.
//!
//! The reader fills pieces of some 32 kB and hands them over; a client that takes none for
//! [`PATIENCE`] is dropped, so that no reader stays in the file for ever. An error after the first
//! piece cuts the answer off: the array is then not closed, which no JSON reader takes for whole.

use super::error::HmiError;
use super::history::{Readers, known_parameter};
use crate::history::{Archive, Filter};
use axum::body::{Body, Bytes};
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use futures_util::stream;
use std::io;
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

/// The parts that `filter` leaves, as a JSON array.
pub(super) async fn parts(readers: &Readers, filter: Filter) -> Result<Response, HmiError> {
    let (archive, place) = readers.open().await?;
    if let Some(param) = filter.param.clone() {
        let check = spawn_blocking(move || known_parameter(&archive, &param).map(|()| archive));
        let archive = check.await.map_err(|_| HmiError::ReaderLost)??;
        return Ok(streamed(archive, place, filter));
    }
    Ok(streamed(archive, place, filter))
}

fn streamed(archive: Archive, place: impl Send + 'static, filter: Filter) -> Response {
    let (sender, receiver) = mpsc::channel::<Piece>(2);
    let runtime = Handle::current();
    spawn_blocking(move || {
        let mut out = Pieces::new(runtime, sender);
        if let Err(error) = write(&archive, &filter, &mut out) {
            // Nobody left to tell when the client has gone.
            let _ = out.send(Err(error));
        }
        drop(place);
    });
    let pieces = stream::unfold(receiver, |mut receiver| async move {
        let piece = receiver.recv().await?;
        Some((piece, receiver))
    });
    (
        [(CONTENT_TYPE, "application/json")],
        Body::from_stream(pieces),
    )
        .into_response()
}

fn write(archive: &Archive, filter: &Filter, out: &mut Pieces) -> io::Result<()> {
    let mut lead = "[\n";
    let all = archive.each(filter, |part| {
        out.text.extend_from_slice(lead.as_bytes());
        lead = ",\n";
        serde_json::to_writer(&mut out.text, &part)?;
        out.full()
    });
    all.map_err(io::Error::other)??;
    out.text
        .extend_from_slice(if lead == "[\n" { b"[]\n" } else { b"\n]\n" });
    out.hand_over()
}

/// The reader's end.
struct Pieces {
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

    fn full(&mut self) -> io::Result<()> {
        if self.text.len() < PIECE {
            return Ok(());
        }
        self.hand_over()
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
