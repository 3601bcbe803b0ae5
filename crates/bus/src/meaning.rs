//! What a reply means: the question before it decides.

use super::{Direction, Entry};

/// Puts replies into words; remembers the last question.
#[derive(Debug)]
pub struct Meaning {
    checksum: bool,
    asked: Vec<u8>,
}

impl Meaning {
    /// For a line whose frames carry checksums or not.
    pub fn new(checksum: bool) -> Self {
        Self {
            checksum,
            asked: Vec::new(),
        }
    }

    /// Of one piece of traffic; a question has none of its own.
    pub fn of(&mut self, entry: &Entry) -> String {
        match entry.direction {
            Direction::Sent => {
                self.asked = entry.bytes().to_vec();
                String::new()
            }
            Direction::Stray => "not asked for, thrown away".to_owned(),
            Direction::Heard => {
                let mut words: Vec<String> =
                    dcon::understand(&self.asked, entry.bytes(), self.checksum)
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
                    more => format!("{} | and {} other readings", words[0], more - 1),
                }
            }
        }
    }
}
