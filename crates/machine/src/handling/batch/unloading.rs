//! Unloading: a person takes out the parts of one list after the other and confirms each list.

use super::BatchTurn;
use super::loading::{choice, list};
use crate::dut::prompt::{Prompt, PromptMoment};
use crate::handling::ledger::Ledger;
use crate::handling::output::Landed;
use crate::handling::place::Place;
use crate::rig::bin::Bin;
use crate::rig::point::DigitalIn;
use crate::rig::rack::Rack;
use texts::{Lang, Message};

/// Choice: the parts of the list are out of the rack.
pub(super) const DONE: &str = "unloaded";
/// Name of the prompt to take out parts without a list.
pub(super) const EMPTY: &str = "batch_empty";

/// What a person takes out next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Content {
    /// The parts of this list.
    Listed(Bin),
    /// Parts without a number: left by an earlier run, or not seen when the rack was loaded.
    Unlisted,
}

/// State of unloading.
#[derive(Debug, Default)]
pub struct Unloading {
    /// What the person takes out now, with the prompt that names the sockets.
    open: Option<(Content, Prompt)>,
    confirmed: bool,
    /// True once the door was open in this phase.
    was_open: bool,
}

impl Unloading {
    pub(super) fn prompt(&self) -> Option<&Prompt> {
        self.open.as_ref().map(|(_, prompt)| prompt)
    }

    pub(super) fn answer(&mut self, prompt: &str, choice: &str) -> bool {
        let open = self.prompt().filter(|it| it.name == prompt);
        if open.and_then(|it| it.choice(choice)).is_none() {
            return false;
        }
        self.confirmed = true;
        true
    }

    /// Performs a turn; returns true when the rack holds no part and every contact is open.
    pub(super) fn step(&mut self, turn: &mut BatchTurn, rack: &Rack) -> bool {
        self.was_open |= turn.input(DigitalIn::DoorClosed) == Some(false);
        let parts = parts(turn.ledger);
        if parts.is_empty() {
            return self.empty(turn, rack);
        }
        if parts.iter().any(|(_, ordinal, _)| *ordinal > turn.recorded) {
            return false;
        }
        let of = |list: Bin| {
            let own = parts.iter().filter(move |(_, _, bin)| *bin == list);
            own.map(|(socket, ..)| *socket).collect::<Vec<u16>>()
        };
        let Some(next) = rack.lists().iter().copied().find(|it| !of(*it).is_empty()) else {
            panic!("a part with a list that the rack lacks");
        };
        let sockets = of(next);
        let contacts = sockets.iter().filter_map(|number| rack.socket(*number));
        let closed = turn.closed(contacts);
        if self.is_out(turn, Content::Listed(next), &sockets, closed) {
            take_out(turn, next, &sockets);
            turn.rig.wake_at = Some(turn.now);
        }
        false
    }

    /// Lets a person take out the parts without a list; returns true when every contact is open.
    fn empty(&mut self, turn: &BatchTurn, rack: &Rack) -> bool {
        match turn.closed(rack.sockets()) {
            Some(closed) if self.open.is_some() || !closed.is_empty() => {
                self.is_out(turn, Content::Unlisted, &closed, Some(closed.clone()))
            }
            closed => closed.is_some(),
        }
    }

    /// Returns true when the parts of these sockets are out: a person has confirmed it, and `closed` is empty. Closed
    /// contacts contradict the person, and the prompt then names them. While contacts are unread, `closed` is `None`
    /// and the answer waits.
    fn is_out(
        &mut self,
        turn: &BatchTurn,
        content: Content,
        sockets: &[u16],
        closed: Option<Vec<u16>>,
    ) -> bool {
        if self.open.as_ref().is_none_or(|(open, _)| *open != content) {
            self.open = Some((content, prompt(content, sockets, &[])));
            self.confirmed = false;
        }
        if !turn.attended {
            self.confirmed = self.was_open;
        }
        let Some(closed) = closed.filter(|_| self.confirmed) else {
            return false;
        };
        self.confirmed = false;
        let is_out = closed.is_empty();
        if is_out {
            self.open = None;
        } else if turn.attended {
            self.open = Some((content, prompt(content, sockets, &closed)));
        }
        is_out
    }
}

/// Returns socket, ordinal and list of each part in the rack.
fn parts(ledger: &Ledger) -> Vec<(u16, u64, Bin)> {
    let each = ledger.each().filter_map(|(place, part)| match place {
        Place::Socket(socket) => part.map(|part| (socket, part)),
        Place::Pocket | Place::Nest(_) | Place::Gripper | Place::Falling => None,
    });
    each.map(|(socket, part)| (socket, part.ordinal, part.bin.unwrap_or(Bin::RETEST)))
        .collect()
}

fn take_out(turn: &mut BatchTurn, list: Bin, sockets: &[u16]) {
    for socket in sockets {
        let part = turn.ledger.unload_socket(*socket);
        turn.parts.landed.push(Landed {
            part,
            bin: list,
            at: turn.now,
        });
    }
}

/// Returns the prompt to take out these parts; `closed`: sockets that contradict a confirmation.
fn prompt(content: Content, sockets: &[u16], closed: &[u16]) -> Prompt {
    let (name, [text_en, text_zh]) = match content {
        Content::Listed(bin) => {
            let said = |lang: Lang| {
                let message = Message::new("batch", "unload")
                    .with("list", lang.name("batch_list", bin.name()))
                    .with("count", sockets.len())
                    .with("sockets", list(sockets))
                    .with("closed", list(closed));
                match closed.is_empty() {
                    true => message.say(lang),
                    false => message.case("closed").say(lang),
                }
            };
            (format!("batch_unload_{bin}"), Lang::ALL.map(said))
        }
        Content::Unlisted => {
            let message = Message::new("batch", "empty").with("sockets", list(sockets));
            (EMPTY.to_owned(), Lang::ALL.map(|lang| message.say(lang)))
        }
    };
    Prompt {
        name,
        when: PromptMoment::Batch,
        text_en,
        text_zh,
        picture: None,
        choices: vec![choice(DONE)],
    }
}
