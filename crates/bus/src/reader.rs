//! The line of a code reader, which sends one line of text per code unprompted and receives nothing.

use super::{OpenPort, Pace, Port};
use tokio::io::AsyncReadExt;
use tokio::sync::mpsc;
use units::Span;

/// Wait before each attempt to open a lost port again.
const REOPEN: Span = Span::ms(1000);
/// Number of characters from which a line counts as a reading without a code.
const LONGEST: usize = 256;

/// Report of a code reader.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Reading {
    /// A line of text; `None` for the text with which the reader reports that it found no code, for a line that is too
    /// long, and for bytes that are not text.
    Line(Option<String>),
    /// The port is open again.
    Open,
    /// The port is lost, or cannot be opened, for this reason.
    Lost(String),
}

/// Passes on each line that the reader sends, until the receiver is gone; reopens a lost port. `no_code` is the text
/// that the reader sends for a reading without a code.
pub async fn run_reader(
    mut open: OpenPort,
    no_code: Option<String>,
    pace: Pace,
    readings: mpsc::Sender<Reading>,
) {
    let mut is_lost = false;
    loop {
        let why = match open() {
            Ok(port) => {
                if std::mem::take(&mut is_lost) && readings.send(Reading::Open).await.is_err() {
                    return;
                }
                match read_lines(port, no_code.as_deref(), &readings).await {
                    None => return,
                    Some(why) => why,
                }
            }
            Err(why) => why.to_string(),
        };
        if !std::mem::replace(&mut is_lost, true)
            && readings.send(Reading::Lost(why)).await.is_err()
        {
            return;
        }
        tokio::select! {
            () = readings.closed() => return,
            () = pace.sleep_until(pace.now() + REOPEN) => {}
        }
    }
}

/// Passes on lines until the port fails; returns why the port is lost, or `None` when the receiver is gone.
async fn read_lines(
    mut port: Box<dyn Port>,
    no_code: Option<&str>,
    readings: &mpsc::Sender<Reading>,
) -> Option<String> {
    let (mut bytes, mut line) = ([0u8; 64], Vec::new());
    loop {
        let count = tokio::select! {
            () = readings.closed() => return None,
            count = port.read(&mut bytes) => count,
        };
        let piece = match count {
            Ok(0) => return Some("the port was closed".to_owned()),
            Ok(count) => &bytes[..count],
            Err(why) => return Some(why.to_string()),
        };
        for byte in piece {
            match byte {
                b'\r' | b'\n' if line.is_empty() => {}
                b'\r' | b'\n' => {
                    let text = String::from_utf8(std::mem::take(&mut line)).ok();
                    let text = text.filter(|it| it.len() < LONGEST && Some(it.trim()) != no_code);
                    readings.send(Reading::Line(text)).await.ok()?;
                }
                byte => {
                    if line.len() < LONGEST {
                        line.push(*byte);
                    }
                }
            }
        }
    }
}
