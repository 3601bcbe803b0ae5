//! Bytes around a message: its end on a raw stream, the commands of a Prologix-type GPIB adapter.

use super::reply::Raw;
use serde::Deserialize;
use units::Span;

/// Longest time that an adapter waits for an instrument, milliseconds.
const ADAPTER_LIMIT_MS: u64 = 3000;
/// Share of the time for a reply after which an adapter gives up, percent: its own line arrives before the time is over,
/// not among the bytes of the next query.
const ADAPTER_SHARE_PCT: u64 = 90;

/// End of a message to the instrument on a raw stream; each reply ends with a line feed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Terminator {
    /// Line feed.
    #[default]
    Lf,
    /// Carriage return and line feed.
    Crlf,
}

impl Terminator {
    const fn bytes(self) -> &'static [u8] {
        match self {
            Self::Lf => b"\n",
            Self::Crlf => b"\r\n",
        }
    }
}

/// What stands between the stream and the instrument.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Framing {
    /// Nothing: messages with this end.
    Direct(Terminator),
    /// A Prologix-type adapter, and the GPIB address of the instrument.
    Adapter(u8),
}

impl Framing {
    /// Returns the lines that set an adapter up; none without one.
    pub fn set_up(self) -> Vec<u8> {
        match self {
            Self::Direct(_) => Vec::new(),
            Self::Adapter(address) => format!(
                "++savecfg 0\n++mode 1\n++auto 0\n++eos 3\n++eoi 1\n++eot_enable 0\n++addr {address}\n"
            )
            .into_bytes(),
        }
    }

    /// Returns what clears the interface of the instrument: a device clear of the adapter, or the end of a message, which
    /// ends half a command that an earlier connection left behind.
    pub fn clear(self) -> Vec<u8> {
        match self {
            Self::Direct(end) => end.bytes().to_vec(),
            Self::Adapter(_) => b"++clr\n".to_vec(),
        }
    }

    /// Returns the bytes of a command.
    pub fn send(self, command: &str) -> Vec<u8> {
        match self {
            Self::Direct(end) => [command.as_bytes(), end.bytes()].concat(),
            Self::Adapter(address) => {
                let mut bytes = format!("++addr {address}\n").into_bytes();
                bytes.extend(escaped(command));
                bytes.push(b'\n');
                bytes
            }
        }
    }

    /// Returns the bytes of a query. An adapter gets the address of the instrument anew with every message.
    pub fn ask(self, command: &str, limit: Span) -> Vec<u8> {
        let mut bytes = self.send(command);
        if let Self::Adapter(_) = self {
            let limit_ms = limit.0 / 1000 * ADAPTER_SHARE_PCT / 100;
            let limit_ms = limit_ms.clamp(1, ADAPTER_LIMIT_MS);
            bytes.extend(format!("++read_tmo_ms {limit_ms}\n++read eoi\n").bytes());
        }
        bytes
    }

    /// Returns the bytes of a message with a question behind it, and the line that must follow: an adapter says its address,
    /// which proves the instrument that was written to and read.
    pub fn proven(self, mut message: Vec<u8>) -> (Vec<u8>, Option<String>) {
        let Self::Adapter(address) = self else {
            return (message, None);
        };
        message.extend(b"++addr\n");
        (message, Some(address.to_string()))
    }
}

impl Framing {
    /// Returns true when a reply has the text of the line that proves the address.
    pub(crate) fn is_proof(self, raw: &Raw) -> bool {
        match (self, raw.text()) {
            (Self::Adapter(address), Ok(text)) => text.parse() == Ok(address),
            (Self::Adapter(_) | Self::Direct(_), _) => false,
        }
    }
}

/// Puts ESC before the characters that an adapter takes for its own.
fn escaped(command: &str) -> impl Iterator<Item = u8> {
    let escape = |byte: u8| matches!(byte, b'\r' | b'\n' | 0x1B | b'+').then_some(0x1B);
    command
        .bytes()
        .flat_map(move |byte| escape(byte).into_iter().chain([byte]))
}
