//! Reasons why a command ends, with their exit status, and the cause of exit status 3.
//!
//! The station ends a run with `Ending::Alarm` when an alarm stops an unattended rig (`machine/src/station/safety.rs`),
//! when the rig stays suspended for too long, or when a person stops a rig in trouble
//! (`machine/src/station/states.rs`). The cycle ends a run in the same way when a module does not fit the wiring
//! (`cycle/src/lib.rs`). The cause of exit status 3 is
//!
//! - chosen in `lot/progress.rs`: the first alarm of the last trouble, or `aborted` after an order; for a lost history
//!   or a failed assertion in `lot/mod.rs` and `service/mod.rs`; for a lot that the rig refuses before it begins in
//!   `admission.rs`; for reference parts without a calibration in `calibration/mod.rs`;
//! - written as a row by `lot/journal.rs` (a refused lot: `admission.rs`) and `history/src/run_end.rs`;
//! - printed on stdout as JSON (`--json`) by `src/cli/terminal.rs`, `src/cli/calibrate.rs` and `src/cli/experiment.rs`;
//! - shown to people by `src/cli/terminal.rs` (log of alarms on stderr), `src/cli/lot.rs` (`lot show`),
//!   `src/cli/history/lots.rs` and page Lots (`page/script/lots.js`).
//!
//! Four causes get no row: `not_calibrated`, a `history_lost` at the end of the run, `script` (`story/mod.rs`), and
//! `hung` (`stop_signals.rs`), which is only logged.

use machine::station::trouble::Alarm;
use serde::Serialize;
use texts::Lang;

/// Reason why a command ends.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Exit {
    /// The command finished, whatever the verdicts about parts.
    Done,
    /// The command finished with a negative answer: a move is blocked, a verification failed, or a figure misses its
    /// bar.
    AnswerIsNo,
    /// Bad input or configuration.
    BadInput,
    /// The rig has trouble, or the program failed.
    Trouble(Cause),
    /// The operator stopped the run.
    Stopped,
}

impl Exit {
    /// Returns the exit status, 0 to 4.
    pub const fn code(&self) -> u8 {
        match self {
            Self::Done => 0,
            Self::AnswerIsNo => 1,
            Self::BadInput => 2,
            Self::Trouble(_) => 3,
            Self::Stopped => 4,
        }
    }

    /// Returns the cause of trouble; `None` for every other end.
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

/// Trouble that ended a command; its exit status is 3.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Cause {
    /// Code of an alarm, or of one of the constructors below; stable over versions.
    pub code: String,
    /// Description in English.
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

    /// `aborted`: a person ordered the abort or the suspension; no alarm caused it.
    pub fn aborted() -> Self {
        Self::new("aborted", "an order aborted the run")
    }

    /// `assertion`: an assertion of the control cycle failed.
    pub fn assertion() -> Self {
        let text = "an assertion of the control cycle failed; the modules' watchdogs make the outputs safe";
        Self::new(ASSERTION, text)
    }

    /// `hung`: the run does not return after a signal that should end the run at once.
    pub fn hung() -> Self {
        let text =
            "the control cycle does not return; the modules' watchdogs make the outputs safe";
        Self::new("hung", text)
    }

    /// `history_lost`: the history cannot be written; `why` is the error.
    pub fn history_lost(why: &str) -> Self {
        Self::new(HISTORY_LOST, why)
    }

    /// `not_calibrated`: the run of the reference parts ended without a calibration.
    pub fn not_calibrated() -> Self {
        let text = "the test of the reference parts gave no calibration";
        Self::new("not_calibrated", text)
    }

    /// Returns true when the program itself failed: an assertion, or a history that cannot be written.
    pub fn is_program_failure(&self) -> bool {
        [ASSERTION, HISTORY_LOST].contains(&self.code.as_str())
    }

    /// `script`: an assertion of the story's player failed.
    pub fn script() -> Self {
        Self::new("script", "an assertion of the script's player failed")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use machine::station::catalogue::AlarmCode;

    #[test]
    fn only_trouble_has_a_cause() {
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
