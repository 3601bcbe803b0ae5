//! The last traffic of a link, and its health; each message carries the number of its program and its generation.

use super::super::log::Log;
use super::super::{Direction, Histogram, arrow, escaped};
use std::collections::{BTreeMap, VecDeque};
use std::fmt;
use units::{RigTime, Span};

/// Number of messages that the log keeps.
const MESSAGES: usize = 1000;
/// Greatest number of bytes of a message that the log keeps; of a longer message it keeps the beginning and the length.
const KEPT: usize = 160;

/// A message, or a piece of one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Traffic {
    /// Number of the program, from 1.
    pub program: u64,
    /// Rig time at which the message, or the piece, was sent or received.
    pub at: RigTime,
    /// Number of resynchronisations before this message.
    generation: u64,
    /// Whether the program sent the message or received it.
    pub direction: Direction,
    /// Beginning of the bytes.
    bytes: Vec<u8>,
    /// Number of bytes of the whole message.
    length: usize,
}

impl Traffic {
    pub(super) fn new(
        at: RigTime,
        (program, generation): (u64, u64),
        direction: Direction,
        bytes: &[u8],
    ) -> Self {
        Self {
            program,
            at,
            generation,
            direction,
            bytes: bytes[..bytes.len().min(KEPT)].to_vec(),
            length: bytes.len(),
        }
    }
}

impl Traffic {
    /// Returns the kept bytes as text, escaped, and the length of a longer message.
    pub fn text(&self) -> String {
        let text = escaped(&self.bytes).replace("\\x0A", "\\n");
        match self.length > self.bytes.len() {
            true => format!("{text} ... {} bytes", self.length),
            false => text,
        }
    }
}

impl fmt::Display for Traffic {
    /// Writes time in microseconds, program and generation, direction (`>` sent, `<` received, `~` discarded), and
    /// bytes.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (at, way) = (self.at.0, arrow(self.direction));
        let (program, generation) = (self.program, self.generation);
        let text = self.text();
        write!(f, "{at} {program}.{generation} {way} {text}")
    }
}

/// Health of a link, counted since its task started.
#[derive(Debug, Clone, Default)]
pub struct LinkHealth {
    /// Programs that have begun, safe programs included.
    pub programs: u64,
    /// Failed programs by the code of the failure, one of [`scpi::Failure::CODES`].
    pub failures: BTreeMap<&'static str, u64>,
    /// Times from query to whole reply.
    pub latency: Histogram,
    /// Identity of the instrument; `None` before the first answer to `*IDN?`.
    pub identity: Option<String>,
}

/// The last messages and the health of a link.
#[derive(Debug, Clone, Default)]
pub struct Ring {
    messages: VecDeque<Traffic>,
    health: LinkHealth,
}

impl Ring {
    pub(super) fn add(&mut self, entry: Traffic) {
        if self.messages.len() >= MESSAGES {
            self.messages.pop_front();
        }
        self.messages.push_back(entry);
    }

    pub(super) fn begun(&mut self) {
        self.health.programs += 1;
    }

    /// Counts the end of a program.
    pub(super) fn ended(&mut self, failure: Option<&'static str>, identity: Option<String>) {
        if let Some(code) = failure {
            *self.health.failures.entry(code).or_default() += 1;
        }
        self.health.identity = identity;
    }

    pub(super) fn answered(&mut self, latency: Span) {
        self.health.latency.add(latency);
    }
}

/// A shared handle to the traffic of a link; a reader never delays the link.
pub type LinkLog = Log<Ring>;

impl LinkLog {
    /// Returns a copy of the traffic, oldest first.
    pub fn traffic(&self) -> Vec<Traffic> {
        self.records().messages.iter().cloned().collect()
    }

    /// Returns a copy of the health.
    pub fn health(&self) -> LinkHealth {
        self.records().health.clone()
    }
}
