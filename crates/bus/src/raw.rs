//! One text over a line, for tools: nothing is known of the command, so nothing is repeated and nothing is believed.

use super::exchange::{Exchange, Frame, Heard};
use super::{LineSettings, Pace};
use dcon::FRAME_LIMIT;
use std::io;
use tokio::io::{AsyncRead, AsyncWrite};
use units::Span;

/// What came back.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RawReply {
    /// The bytes, CR included; empty when there were none in time.
    pub bytes: Vec<u8>,
    /// More was heard behind.
    pub more: bool,
    /// From the first character sent to the last heard, or to the time-out.
    pub taken: Span,
}

/// Sends `request`, CR included, and waits for a frame as long as the slowest module may take.
///
/// # Errors
/// The port's own.
pub async fn send_raw<P: AsyncRead + AsyncWrite + Unpin>(
    port: &mut P,
    settings: &LineSettings,
    pace: Pace,
    request: &[u8],
) -> io::Result<RawReply> {
    let log = &settings.log;
    let mut exchange = Exchange { port, pace, log };
    exchange.discard().await?;
    let begun = pace.now();
    let limit =
        settings.wire().time(request.len() + FRAME_LIMIT) + Span::ms(settings.store_allowance_ms);
    let mut frame = Frame::new();
    let heard = exchange.ask(request, begun + limit, &mut frame).await?;
    let taken = pace.now().since(begun);
    pace.rest_until(pace.now() + settings.turnaround()).await;
    let behind = exchange.discard().await?;
    Ok(RawReply {
        bytes: frame.bytes().to_vec(),
        more: behind > 0 || matches!(heard, Heard::More | Heard::TooLong),
        taken,
    })
}
