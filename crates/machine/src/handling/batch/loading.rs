//! Loading: a person opens the door, fills the sockets and closes the door.

use super::BatchTurn;
use crate::dut::prompt::{Choice, Prompt, PromptMoment};
use crate::handling::trouble::Trouble;
use crate::rig::point::DigitalIn;
use crate::rig::rack::Rack;
use texts::{Lang, Message};
use units::{RigTime, Span};

/// Time for which the door must stay closed before the rack counts as loaded.
const SETTLED: Span = Span::ms(3_000);
/// Time from the closing of the door after which a rack loaded without a screen must show a closed contact.
const SILENT: Span = Span::ms(600_000);
/// Name of the prompt.
pub(super) const LOADED: &str = "batch_loaded";
/// Choice: the sockets whose contact is closed hold parts, and no others.
pub(super) const AS_SEEN: &str = "as_seen";
/// Choice: every expected socket holds a part, even where its contact is open.
pub(super) const ALL: &str = "all";

/// State of loading.
#[derive(Debug, Default)]
pub struct Loading {
    closed_since: Option<RigTime>,
    /// True once the door was open in this phase. Without this, a rack counts as loaded only at a screen, by a closed
    /// contact.
    was_open: bool,
    prompt: Option<Prompt>,
    /// Sockets with a closed contact for which the prompt was made.
    asked: Vec<u16>,
    /// Answer of the person: true when every expected socket holds a part, false when only those in `asked` do.
    answer: Option<bool>,
}

impl Loading {
    /// Begins to load; a door that is open at this moment counts as opened.
    pub(super) fn begin(turn: &BatchTurn) -> Self {
        Self {
            was_open: turn.input(DigitalIn::DoorClosed) == Some(false),
            ..Self::default()
        }
    }

    pub(super) fn prompt(&self) -> Option<&Prompt> {
        self.prompt.as_ref()
    }

    pub(super) fn answer(&mut self, prompt: &str, choice: &str) -> bool {
        let open = self.prompt.as_ref().filter(|it| it.name == prompt);
        if open.and_then(|it| it.choice(choice)).is_none() {
            return false;
        }
        self.answer = Some(choice == ALL);
        true
    }

    /// Forgets the open prompt and for how long the door has been closed.
    pub(super) fn rest(&mut self) {
        let was_open = self.was_open;
        *self = Self {
            was_open,
            ..Self::default()
        };
    }

    /// Performs a turn; returns the filled sockets once the rack is loaded.
    pub(super) fn step(&mut self, turn: &mut BatchTurn, rack: &Rack) -> Option<Vec<u16>> {
        if !self.is_closed(turn) || !turn.begins {
            (self.prompt, self.answer) = (None, None);
            return None;
        }
        let seen = turn.closed(rack.sockets())?;
        let expected = expected(turn, rack, &seen);
        let is_loaded = self.was_open || turn.attended && !seen.is_empty();
        if !is_loaded || expected.is_empty() {
            (self.prompt, self.answer) = (None, None);
            return None;
        }
        if turn.attended {
            return self.ask(seen, expected);
        }
        if seen.is_empty() {
            self.report_silence(turn);
            return None;
        }
        let is_counted = turn.lacking.is_some();
        Some(if is_counted { expected } else { seen })
    }

    /// Performs a turn before an experiment; returns true once the door is closed.
    pub(super) fn is_shut(&mut self, turn: &mut BatchTurn) -> bool {
        self.is_closed(turn) && turn.begins
    }

    /// Asks the person which sockets are filled; returns them once the person has answered.
    fn ask(&mut self, seen: Vec<u16>, expected: Vec<u16>) -> Option<Vec<u16>> {
        if self.asked != seen || self.prompt.is_none() {
            self.answer = None;
            self.prompt = Some(prompt(&seen, &expected));
            self.asked = seen.clone();
        }
        let all = self.answer.take()?;
        Some(if all { expected } else { seen })
    }

    fn report_silence(&self, turn: &mut BatchTurn) {
        let waited = self.closed_since.map(|at| turn.now.since(at));
        if let Some(waited) = waited.filter(|it| *it > SILENT) {
            turn.trouble.push(Trouble::TooLong("loading", waited));
        }
    }

    /// Returns true once the door has been closed for long enough.
    fn is_closed(&mut self, turn: &mut BatchTurn) -> bool {
        let closed = turn.input(DigitalIn::DoorClosed);
        self.was_open |= closed == Some(false);
        if closed != Some(true) {
            self.closed_since = None;
            return false;
        }
        let since = *self.closed_since.get_or_insert(turn.now);
        let left = SETTLED.0.saturating_sub(turn.now.since(since).0);
        if left > 0 {
            turn.wake_within(Span(left));
        }
        left == 0
    }
}

/// Returns the sockets that a person should fill for this batch: those with a closed contact, then the first others
/// until the lot lacks no part. Parts with a closed contact are all tested, even when the lot lacks fewer, so that
/// nothing is heated without a row.
fn expected(turn: &BatchTurn, rack: &Rack, seen: &[u16]) -> Vec<u16> {
    let lacking = turn.lacking.map_or(usize::MAX, |lacking| {
        usize::try_from(lacking).unwrap_or(usize::MAX)
    });
    let numbers = rack.sockets().iter().map(|it| it.number);
    let open = numbers.filter(|it| !seen.contains(it));
    let silent = open.take(lacking.saturating_sub(seen.len()));
    let mut expected: Vec<u16> = seen.iter().copied().chain(silent).collect();
    expected.sort_unstable();
    expected
}

fn prompt(seen: &[u16], expected: &[u16]) -> Prompt {
    let open: Vec<u16> = expected
        .iter()
        .copied()
        .filter(|it| !seen.contains(it))
        .collect();
    let case = match open.is_empty() {
        true => "complete",
        false => "gaps",
    };
    let message = Message::new("batch", "loaded")
        .with("count", seen.len())
        .with("sockets", list(&open))
        .case(case);
    let choice = |name: &str| choice(name);
    Prompt {
        name: LOADED.to_owned(),
        when: PromptMoment::Batch,
        text_en: message.say(Lang::En),
        text_zh: message.say(Lang::Zh),
        picture: None,
        choices: match (seen.is_empty(), open.is_empty()) {
            (true, _) => vec![choice(ALL)],
            (false, true) => vec![choice(AS_SEEN)],
            (false, false) => vec![choice(AS_SEEN), choice(ALL)],
        },
    }
}

/// Returns the choice with this name, labelled in both languages.
pub(super) fn choice(name: &str) -> Choice {
    let [text_en, text_zh] = Lang::ALL.map(|lang| lang.name("batch_choice", name).to_owned());
    Choice {
        name: name.to_owned(),
        text_en,
        text_zh,
        stops: false,
    }
}

/// Returns the numbers of sockets as text, with runs of at least three joined: `1-3, 7, 9`.
pub(super) fn list(sockets: &[u16]) -> String {
    let mut runs: Vec<(u16, u16)> = Vec::new();
    for &socket in sockets {
        match runs.last_mut() {
            Some((_, last)) if *last + 1 == socket => *last = socket,
            Some(_) | None => runs.push((socket, socket)),
        }
    }
    let words = runs.into_iter().map(|(first, last)| match last - first {
        0 => first.to_string(),
        1 => format!("{first}, {last}"),
        2.. => format!("{first}-{last}"),
    });
    words.collect::<Vec<_>>().join(", ")
}
