//! The last traffic of a link; each message carries the number of its program and its generation.

use super::super::log::Log;
use super::super::{Direction, arrow, escaped};
use std::collections::VecDeque;
use std::fmt;
use units::RigTime;

/// Number of messages that the log keeps.
const MESSAGES: usize = 1000;
/// Greatest number of bytes of a message that the log keeps; of a longer message it keeps the beginning and the length.
const KEPT: usize = 160;

/// A message, or a piece of one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Traffic {
    /// Number of the program, from 1.
    pub program: u64,
    at: RigTime,
    /// Number of resynchronisations before this message.
    generation: u64,
    direction: Direction,
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

impl fmt::Display for Traffic {
    /// Writes time in microseconds, program and generation, direction (`>` sent, `<` received, `~` discarded), and
    /// bytes.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (at, way) = (self.at.0, arrow(self.direction));
        let (program, generation) = (self.program, self.generation);
        let text = escaped(&self.bytes).replace("\\x0A", "\\n");
        write!(f, "{at} {program}.{generation} {way} {text}")?;
        match self.length > self.bytes.len() {
            true => write!(f, " ... {} bytes", self.length),
            false => Ok(()),
        }
    }
}

/// The last messages of a link.
#[derive(Debug, Clone, Default)]
pub struct Ring(VecDeque<Traffic>);

impl Ring {
    pub(super) fn add(&mut self, entry: Traffic) {
        if self.0.len() >= MESSAGES {
            self.0.pop_front();
        }
        self.0.push_back(entry);
    }
}

/// A shared handle to the traffic of a link; a reader never delays the link.
pub type LinkLog = Log<Ring>;

impl LinkLog {
    /// Returns a copy of the traffic, oldest first.
    pub fn traffic(&self) -> Vec<Traffic> {
        self.records().0.iter().cloned().collect()
    }
}
