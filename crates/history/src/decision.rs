//! Decisions that a person takes about a lot while no run of it is under way.

use super::LotState;
use texts::Message;

/// A decision about a lot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Decision {
    /// No run of the lot may begin until it is released.
    Hold,
    /// The lot may be run again.
    Release,
    /// The lot is complete.
    Close,
    /// The complete lot may be run again.
    Reopen,
}

impl Decision {
    /// All decisions.
    pub const ALL: [Self; 4] = [Self::Hold, Self::Release, Self::Close, Self::Reopen];

    /// Returns the name of the order that gives this decision.
    pub const fn order(self) -> &'static str {
        match self {
            Self::Hold => "hold_lot",
            Self::Release => "release_lot",
            Self::Close => "close_lot",
            Self::Reopen => "reopen_lot",
        }
    }

    /// Returns the new state of the lot; the history stores `Complete` in place of `Open` for a lot that was complete
    /// before a hold.
    pub const fn becomes(self) -> LotState {
        match self {
            Self::Hold => LotState::Held,
            Self::Release | Self::Reopen => LotState::Open,
            Self::Close => LotState::Complete,
        }
    }

    /// Returns why this decision is refused for a lot in this state; `None` when it is possible.
    pub fn refusal(self, state: LotState) -> Option<Message> {
        let refused = |code| Some(Message::new("refusal", code));
        match (self, state) {
            (Self::Hold, LotState::Held) => refused("lot_held_already"),
            (Self::Release, LotState::Open | LotState::Running | LotState::Complete) => {
                refused("lot_not_held")
            }
            (Self::Close, LotState::Complete) => refused("lot_complete"),
            (Self::Reopen, LotState::Open | LotState::Running | LotState::Held) => {
                refused("lot_not_complete")
            }
            (Self::Hold, LotState::Open | LotState::Running | LotState::Complete)
            | (Self::Release, LotState::Held)
            | (Self::Close, LotState::Open | LotState::Running | LotState::Held)
            | (Self::Reopen, LotState::Complete) => None,
        }
    }

    /// Checks that a hold or a reopening has a reason.
    ///
    /// # Errors
    /// Fails with the refusal when the reason is blank.
    pub fn check_reason(self, reason: &str) -> Result<(), Message> {
        let code = match self {
            Self::Hold => "hold_without_reason",
            Self::Reopen => "reopen_without_reason",
            Self::Release | Self::Close => return Ok(()),
        };
        match reason.trim().is_empty() {
            true => Err(Message::new("refusal", code)),
            false => Ok(()),
        }
    }
}
