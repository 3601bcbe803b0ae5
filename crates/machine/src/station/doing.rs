//! What the station is doing, as a screen shows it: closer than the state of the outer machine.

use super::packml::State;

/// What the station is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Doing {
    /// The run is over.
    Ended,
    /// Safety inputs were not read yet.
    WaitingForSensors,
    /// Actuators go to their rest ends.
    Homing,
    /// Parts found inside are discharged.
    Discharging,
    /// References are measured.
    Calibrating,
    /// A part is measured; the stage of its test.
    Testing(&'static str),
    /// Parts of the lot are on their way.
    Running,
    /// Golden parts are on their way.
    ReferenceParts,
    /// What the state of the outer machine says.
    Resting(State),
}

impl Doing {
    /// Its code: the texts are those of the family `state`.
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

    /// The stage of the test: the texts are those of the family `stage`.
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

    /// The state of a view: the code with blanks, and the stage behind it.
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
        for stage in Kind::ALL.into_iter().flat_map(Kind::stages) {
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
