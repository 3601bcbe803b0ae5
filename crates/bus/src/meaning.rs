//! Texts of the traffic of a line; the meaning of a reply depends on its request.

use super::{Direction, Entry, words};
use dcon::{Command, Model, Reply, ReplyError};
use texts::{Lang, Message};

/// Greatest number of meanings of one reply that a text lists; of more, it lists these and states the number of others.
const LISTED: usize = 3;

/// Decodes each reply with the last request, which it remembers.
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

    /// Returns the text of an entry in each language of `langs`. A reply gets a text together with its request, a
    /// broadcast gets one by itself, and bytes without a request get one that says so; the text of any other request is
    /// empty.
    pub fn of<const N: usize>(&mut self, entry: &Entry, langs: [Lang; N]) -> [String; N] {
        let reply: &[u8] = match entry.direction {
            Direction::Stray => return langs.map(|it| it.text("exchange-unsolicited").to_owned()),
            Direction::Received => entry.bytes(),
            Direction::Sent => {
                self.request = entry.bytes().to_vec();
                if self.request.get(1..3) != Some(b"**") {
                    return langs.map(|_| String::new());
                }
                b""
            }
        };
        let found = dcon::interpret(&self.request, reply, self.checksum, None);
        langs.map(|lang| listed(lang, &meanings(&found, None, lang)))
    }
}

/// Returns a text for each meaning in `found`, the result of [`dcon::interpret`]; merges equal neighbours. With
/// `model`, the texts separate digital inputs from outputs.
pub fn meanings(
    found: &[(Command, Result<Reply, ReplyError>)],
    model: Option<Model>,
    lang: Lang,
) -> Vec<String> {
    let words = |(command, outcome): &(_, _)| words::exchange(lang, command, outcome, model);
    let mut said: Vec<String> = found.iter().map(words).collect();
    said.dedup();
    said
}

fn listed(lang: Lang, words: &[String]) -> String {
    match words.len() {
        0 => lang.text("exchange-unknown").to_owned(),
        1..=LISTED => words.join(" | "),
        more => Message::new("exchange", "several")
            .with("first", &words[0])
            .with("more", more - 1)
            .say(lang),
    }
}
