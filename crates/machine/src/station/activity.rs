//! Activity of the station for views, in more detail than the PackML state.

use super::packml::State;

/// Activity of the station; each variant says what the station does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Activity {
    /// The run is over.
    Ended,
    /// Waits until the safety inputs are read for the first time.
    WaitingForSensors,
    /// Moves actuators to their rest ends.
    Homing,
    /// Discharges parts found inside.
    Discharging,
    /// Measures the references.
    Calibrating,
    /// Tests a part, at the named stage.
    Testing(&'static str),
    /// Handles parts of the lot.
    Running,
    /// Handles reference parts.
    ReferenceParts,
    /// Rests in this PackML state and does nothing else.
    Resting(State),
}

impl Activity {
    /// Returns the code: the key of its text in the family `state`.
    pub fn code(self) -> String {
        let code = match self {
            Self::Ended => "ended",
            Self::WaitingForSensors => "waiting_for_sensors",
            Self::Homing => "homing",
            Self::Discharging => "discharging",
            Self::Calibrating => "calibrating",
            Self::Testing(_) => "testing",
            Self::Running => "running",
            Self::ReferenceParts => "golden_parts",
            Self::Resting(state) => return state.name().to_lowercase(),
        };
        code.to_owned()
    }

    /// Returns the stage of the test, which is the key of its text in the family `stage`; `None` without a test.
    pub fn stage(self) -> Option<&'static str> {
        let Self::Testing(stage) = self else {
            return None;
        };
        Some(stage)
    }

    /// Returns the words for a view: the code with blanks instead of underscores, followed by the stage.
    pub fn name(self) -> String {
        let code = self.code().replace('_', " ");
        match self.stage() {
            Some(stage) => format!("{code}: {stage}"),
            None => code,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dut::Kind;

    #[test]
    fn every_state_and_stage_has_a_text() {
        let known: Vec<&str> = texts::plain().map(|it| it.id).collect();
        let inner = [
            Activity::Ended,
            Activity::WaitingForSensors,
            Activity::Homing,
            Activity::Discharging,
            Activity::Calibrating,
            Activity::Testing("Off"),
            Activity::Running,
            Activity::ReferenceParts,
        ];
        let outer = State::ALL.iter().map(|state| Activity::Resting(*state));
        for activity in inner.into_iter().chain(outer) {
            assert!(
                known.contains(&format!("state-{}", activity.code()).as_str()),
                "{activity:?}"
            );
        }
        for stage in Kind::ALL
            .into_iter()
            .flat_map(|kind| (kind.definition().stages)())
        {
            assert!(
                known.contains(&format!("stage-{stage}").as_str()),
                "{stage}"
            );
        }
    }

    #[test]
    fn a_view_names_the_stage_behind_the_state() {
        assert_eq!(Activity::Testing("Coil").name(), "testing: Coil");
        assert_eq!(Activity::WaitingForSensors.name(), "waiting for sensors");
        assert_eq!(Activity::Resting(State::Held).name(), "held");
    }
}
