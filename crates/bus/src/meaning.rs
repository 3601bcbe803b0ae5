//! Puts replies into words; what a reply means depends on its request.

use super::{Direction, Entry};

/// Puts replies into words; remembers the last request for that.
#[derive(Debug)]
pub struct Meaning {
    checksum: bool,
    request: Vec<u8>,
}

impl Meaning {
    /// Creates a decoder that has seen no request; `checksum` says whether frames of the line carry one.
    pub fn new(checksum: bool) -> Self {
        Self {
            checksum,
            request: Vec::new(),
        }
    }

    /// Returns the meaning of a reply in words; an empty text for a request.
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
