//! Decodes replies; the meaning of a reply depends on its request.

use super::{Direction, Entry};

/// Decodes replies into words; keeps the last request.
#[derive(Debug)]
pub struct Meaning {
    checksum: bool,
    request: Vec<u8>,
}

impl Meaning {
    /// Starts without a request; `checksum`: frames of the line carry one.
    pub fn new(checksum: bool) -> Self {
        Self {
            checksum,
            request: Vec::new(),
        }
    }

    /// Returns the meaning of a reply; empty for a request.
    pub fn of(&mut self, entry: &Entry) -> String {
        match entry.direction {
            Direction::Sent => {
                self.request = entry.bytes().to_vec();
                String::new()
            }
            Direction::Stray => "unsolicited, discarded".to_owned(),
            Direction::Received => {
                let mut words: Vec<String> =
                    dcon::interpret(&self.request, entry.bytes(), self.checksum)
                        .into_iter()
                        .map(|(command, reply)| match reply {
                            Ok(reply) => format!("{command} = {reply}"),
                            Err(reason) => format!("{command}: {reason}"),
                        })
                        .collect();
                words.dedup();
                match words.len() {
                    0 => "no known command".to_owned(),
                    1..=3 => words.join(" | "),
                    more => format!("{} | and {} other meanings", words[0], more - 1),
                }
            }
        }
    }
}
