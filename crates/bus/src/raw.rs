//! Sends one raw frame, for tools. The frame may hold any command; this module repeats and checks nothing.

use super::exchange::{Exchange, Frame, FrameEnd};
use super::{LineSettings, Pace, Port, Timer};
use dcon::FRAME_LIMIT;
use std::io;
use units::Span;

/// The bytes received in reply.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RawReply {
    /// Bytes of the frame, CR included; empty when none came in time.
    pub bytes: Vec<u8>,
    /// True when more bytes followed the frame.
    pub more: bool,
    /// Time from the first character sent to the last one received, or to the time-out.
    pub taken: Span,
}

/// Sends `request`, which must include its CR, and waits for one frame as long as the slowest module may take.
///
/// # Errors
/// Fails when the port does.
pub async fn send_raw(
    port: &mut dyn Port,
    settings: &LineSettings,
    pace: Pace,
    request: &[u8],
) -> io::Result<RawReply> {
    let log = &settings.log;
    let timer = &Timer::new(pace);
    let mut exchange = Exchange {
        port,
        pace,
        timer,
        log,
    };
    exchange.discard().await?;
    let begun = pace.now();
    let limit =
        settings.wire().time(request.len() + FRAME_LIMIT) + Span::ms(settings.store_allowance_ms);
    let mut frame = Frame::new();
    let heard = exchange.ask(request, begun + limit, &mut frame).await?;
    let taken = pace.now().since(begun);
    timer.until(pace.now() + settings.turnaround()).await;
    let behind = exchange.discard().await?;
    Ok(RawReply {
        bytes: frame.bytes().to_vec(),
        more: behind > 0 || matches!(heard, FrameEnd::More | FrameEnd::TooLong),
        taken,
    })
}
