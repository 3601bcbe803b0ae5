//! Names the digital signals that the messages of a line carry, as `rig.toml` names them.

use bus::{Direction, Entry};
use dcon::{Command, Digital, Reply};
use machine::rig::wiring::{LineId, Wiring};
use std::collections::BTreeMap;

/// Finds signals in replies; keeps the last request, because a reply alone names no module.
#[derive(Debug)]
pub(super) struct Signals<'a> {
    wiring: &'a Wiring,
    line: LineId,
    request: Vec<u8>,
}

impl<'a> Signals<'a> {
    /// Creates a finder that has seen no request.
    pub fn new(wiring: &'a Wiring, line: LineId) -> Self {
        Self {
            wiring,
            line,
            request: Vec::new(),
        }
    }

    /// Returns the state of every signal that a reply reports, or whose setting it confirms; empty for any other
    /// message.
    pub fn of(&mut self, entry: &Entry) -> BTreeMap<String, bool> {
        match entry.direction {
            Direction::Sent => self.request = entry.bytes().to_vec(),
            Direction::Stray => {}
            Direction::Received => return self.read(entry.bytes()).unwrap_or_default(),
        }
        BTreeMap::new()
    }

    fn read(&self, reply: &[u8]) -> Option<BTreeMap<String, bool>> {
        let checksum = self.wiring.line(self.line).checksum;
        let meanings = dcon::interpret(&self.request, reply, checksum, None);
        let bits = |(command, reply)| match (command, reply) {
            (Command::Digital(to, Digital::ReadPort | Digital::ReadAll), Ok(Reply::Bits(bits))) => {
                Some((to, bits.word()))
            }
            (Command::Digital(to, Digital::Write(word)), Ok(Reply::Accepted)) => {
                Some((to, word.bits()))
            }
            _other => None,
        };
        let mut found = meanings.into_iter().filter_map(bits);
        found.find_map(|(to, bits)| {
            let module = self.wiring.at(self.line, to)?;
            let wired = self.wiring.signals(module, bits);
            Some(wired.map(|(name, on)| (name.to_owned(), on)).collect())
        })
    }
}
