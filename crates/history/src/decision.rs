//! What a person decides about a lot that is not under way, and when that makes no sense.

use super::LotState;
use texts::Message;

/// A decision about a lot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Decision {
    /// No run before somebody releases it.
    Hold,
    /// It may be run again.
    Release,
    /// It is complete as it is.
    Close,
}

impl Decision {
    /// Every one.
    pub const ALL: [Self; 3] = [Self::Hold, Self::Release, Self::Close];

    /// The word of its order.
    pub const fn order(self) -> &'static str {
        match self {
            Self::Hold => "hold_lot",
            Self::Release => "release_lot",
            Self::Close => "close_lot",
        }
    }

    /// The one of this word.
    pub fn ordered(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|it| it.order() == word)
    }

    /// The state that it puts a lot into.
    pub const fn becomes(self) -> LotState {
        match self {
            Self::Hold => LotState::Held,
            Self::Release => LotState::Open,
            Self::Close => LotState::Complete,
        }
    }

    /// Why it makes no sense of a lot in this state.
    pub fn why_not(self, state: LotState) -> Option<Message> {
        let refused = |code| Some(Message::new("refusal", code));
        match (self, state) {
            (Self::Hold, LotState::Held) => refused("lot_held_already"),
            (Self::Release, LotState::Open | LotState::Running | LotState::Complete) => {
                refused("lot_not_held")
            }
            (Self::Close, LotState::Complete) => refused("lot_complete"),
            (Self::Hold, LotState::Open | LotState::Running | LotState::Complete)
            | (Self::Release, LotState::Held)
            | (Self::Close, LotState::Open | LotState::Running | LotState::Held) => None,
        }
    }
}
