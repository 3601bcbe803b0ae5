//! Activity of the station for screens, in more detail than the state of the outer machine.

use super::packml::State;

/// Activity of the station.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Doing {
    /// The run is over.
    Ended,
    /// Waits for the first reading of the safety inputs.
    WaitingForSensors,
    /// Moves actuators to their rest ends.
    Homing,
    /// Discharges parts found inside.
    Discharging,
    /// Measures the references.
    Calibrating,
    /// Tests a part; the name of the stage.
    Testing(&'static str),
    /// Handles parts of the lot.
    Running,
    /// Handles reference parts.
    ReferenceParts,
    /// None of these; the state of the outer machine.
    Resting(State),
}

impl Doing {
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

    /// Returns the stage of the test: the key of its text in the family `stage`.
    pub fn stage(self) -> Option<&'static str> {
        match self {
            Self::Testing(stage) => Some(stage),
            Self::Ended
            | Self::WaitingForSensors
            | Self::Homing
            | Self::Discharging
            | Self::Calibrating
            | Self::Running
            | Self::ReferenceParts
            | Self::Resting(_) => None,
        }
    }

    /// Returns the words of a view: the code with blanks, followed by the stage.
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
            Doing::Ended,
            Doing::WaitingForSensors,
            Doing::Homing,
            Doing::Discharging,
            Doing::Calibrating,
            Doing::Testing("Off"),
            Doing::Running,
            Doing::ReferenceParts,
        ];
        let outer = State::ALL.iter().map(|state| Doing::Resting(*state));
        for doing in inner.into_iter().chain(outer) {
            assert!(
                known.contains(&format!("state-{}", doing.code()).as_str()),
                "{doing:?}"
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
        assert_eq!(Doing::Testing("Coil").name(), "testing: Coil");
        assert_eq!(Doing::WaitingForSensors.name(), "waiting for sensors");
        assert_eq!(Doing::Resting(State::Held).name(), "held");
    }
}
