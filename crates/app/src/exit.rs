//! Why a command ended, with its exit status.
//!
//! `lot/progress.rs` (alarm, abort) and `lot/mod.rs` (assertion, lost history) choose the cause of a status 3, table `run_end` of
//! the history stores it, `relayrig lot` and the page Lots show it.

use machine::station::trouble::Alarm;
use serde::Serialize;
use texts::Lang;

/// Why a command ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Exit {
    /// Everything finished, whatever the verdicts.
    Done,
    /// Everything finished, and the answer is no: a move is blocked, a verification failed, a bar is missed.
    AnswerIsNo,
    /// Bad input or configuration.
    BadInput,
    /// The rig has trouble.
    Trouble(Cause),
    /// The operator stopped it.
    Stopped,
}

impl Exit {
    /// Status that the shell sees, 0 to 4.
    pub const fn code(&self) -> u8 {
        match self {
            Self::Done => 0,
            Self::AnswerIsNo => 1,
            Self::BadInput => 2,
            Self::Trouble(_) => 3,
            Self::Stopped => 4,
        }
    }

    /// What the trouble is; none for every other end.
    pub const fn cause(&self) -> Option<&Cause> {
        match self {
            Self::Trouble(cause) => Some(cause),
            Self::Done | Self::AnswerIsNo | Self::BadInput | Self::Stopped => None,
        }
    }
}

/// Code of [`Cause::assertion`].
const ASSERTION: &str = "assertion";
/// Code of [`Cause::history_lost`].
const HISTORY_LOST: &str = "history_lost";

/// What ended a run with status 3.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Cause {
    /// Code of an alarm, or one of the codes of [`Cause`]'s constructors; it stays the same over versions.
    pub code: String,
    /// What happened, English.
    pub text: String,
}

impl From<&Alarm> for Cause {
    fn from(alarm: &Alarm) -> Self {
        Self::new(&alarm.code.name(), &alarm.text(Lang::En))
    }
}

impl Cause {
    fn new(code: &str, text: &str) -> Self {
        assert!(!code.is_empty(), "a cause without a code");
        Self {
            code: code.to_owned(),
            text: text.to_owned(),
        }
    }

    /// `aborted`: a person ordered the abort and no alarm stood.
    pub fn aborted() -> Self {
        Self::new("aborted", "the run was aborted by order")
    }

    /// `assertion`: the control cycle found a mistake of this program.
    pub fn assertion() -> Self {
        let text =
            "the control cycle ended by an assertion; the modules' watchdogs make the outputs safe";
        Self::new(ASSERTION, text)
    }

    /// `history_lost`: rows could not be written, `why` says what the file answered.
    pub fn history_lost(why: &str) -> Self {
        Self::new(HISTORY_LOST, why)
    }

    /// `calibration_invalid`: the rig takes no lot before it is calibrated again.
    pub fn calibration_invalid(why: &str) -> Self {
        Self::new("calibration_invalid", why)
    }

    /// `not_calibrated`: the golden parts ended without a calibration.
    pub fn not_calibrated() -> Self {
        let text = "the golden parts ended without a calibration";
        Self::new("not_calibrated", text)
    }

    /// Returns true when the program itself failed: an assertion, or a history that cannot be written.
    pub fn is_program_failure(&self) -> bool {
        [ASSERTION, HISTORY_LOST].contains(&self.code.as_str())
    }

    /// `script`: the player of a story ended by an assertion.
    pub fn script() -> Self {
        Self::new("script", "the player of the script ended by an assertion")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use machine::station::catalogue::AlarmCode;

    #[test]
    fn only_trouble_has_a_cause_and_every_end_its_status() {
        let cause = Cause::from(&AlarmCode::PartNotArrived.into());
        assert_eq!(cause.code, "part_not_arrived");
        let trouble = Exit::Trouble(cause);
        let ends = [
            Exit::Done,
            Exit::AnswerIsNo,
            Exit::BadInput,
            trouble,
            Exit::Stopped,
        ];
        assert_eq!(ends.each_ref().map(Exit::code), [0, 1, 2, 3, 4]);
        assert_eq!(ends.iter().filter(|it| it.cause().is_some()).count(), 1);
    }
}
