//! Bytes around a message: the terminator on a raw stream, the commands of a Prologix-type GPIB adapter.

use super::reply::Raw;
use serde::Deserialize;
use units::Span;

/// Longest time that an adapter waits for an instrument, milliseconds.
const ADAPTER_LIMIT_MS: u64 = 3000;
/// Share of the reply time after which an adapter gives up, percent. Its own line then arrives before the reply time is
/// over, and not among the bytes of the next query.
const ADAPTER_SHARE_PCT: u64 = 90;

/// Terminator of a message to the instrument on a raw stream; each reply ends with a line feed in any case.
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

/// Framing of messages between the stream and the instrument.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Framing {
    /// No adapter: messages end with this terminator.
    Direct(Terminator),
    /// A Prologix-type adapter, and the GPIB address of the instrument.
    Adapter(u8),
}

impl Framing {
    /// Returns the lines that set up an adapter; empty without an adapter.
    pub fn set_up(self) -> Vec<u8> {
        match self {
            Self::Direct(_) => Vec::new(),
            Self::Adapter(address) => format!(
                "++savecfg 0\n++mode 1\n++auto 0\n++eos 3\n++eoi 1\n++eot_enable 0\n++addr {address}\n"
            )
            .into_bytes(),
        }
    }

    /// Returns the bytes that clear the interface of the instrument: a device clear of the adapter, or a terminator,
    /// which ends half a command that an earlier connection left behind.
    pub fn clear(self) -> Vec<u8> {
        match self {
            Self::Direct(end) => end.bytes().to_vec(),
            Self::Adapter(_) => b"++clr\n".to_vec(),
        }
    }

    /// Returns the bytes of a command, framing included.
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

    /// Returns the bytes of a query, framing included. Every message repeats the GPIB address for the adapter.
    pub fn ask(self, command: &str, limit: Span) -> Vec<u8> {
        let mut bytes = self.send(command);
        if let Self::Adapter(_) = self {
            let limit_ms = limit.0 / 1000 * ADAPTER_SHARE_PCT / 100;
            let limit_ms = limit_ms.clamp(1, ADAPTER_LIMIT_MS);
            bytes.extend(format!("++read_tmo_ms {limit_ms}\n++read eoi\n").bytes());
        }
        bytes
    }

    /// Returns the message followed by a question to the adapter, and the line that must follow the reply: the adapter
    /// states its present address, which proves which instrument it wrote to and read. Without an adapter, the message
    /// stays as it is.
    pub fn proven(self, mut message: Vec<u8>) -> (Vec<u8>, Option<String>) {
        let Self::Adapter(address) = self else {
            return (message, None);
        };
        message.extend(b"++addr\n");
        (message, Some(address.to_string()))
    }
}

impl Framing {
    /// Returns true when a reply looks like the line that proves the address.
    pub(crate) fn is_proof(self, raw: &Raw) -> bool {
        match (self, raw.text()) {
            (Self::Adapter(address), Ok(text)) => text.parse() == Ok(address),
            (Self::Adapter(_) | Self::Direct(_), _) => false,
        }
    }
}

/// Puts ESC before the characters that an adapter would interpret itself.
fn escaped(command: &str) -> impl Iterator<Item = u8> {
    let escape = |byte: u8| matches!(byte, b'\r' | b'\n' | 0x1B | b'+').then_some(0x1B);
    command
        .bytes()
        .flat_map(move |byte| escape(byte).into_iter().chain([byte]))
}
