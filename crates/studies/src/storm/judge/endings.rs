//! Checks that every life ends by itself unless the study kills it, that every life that ended in trouble has an alarm
//! in the history, and that production resumes after the faults: the last life completes its lot.

use super::{Case, seconds};
use crate::storm::life::{End, EndedLife};
use app::exit::Exit;

pub fn violations(case: &Case) -> Vec<String> {
    let mut violations: Vec<String> = case
        .lives
        .iter()
        .filter_map(|life| of(case, life))
        .collect();
    if case
        .lives
        .last()
        .is_none_or(|life| life.end != End::Exit(Exit::Done))
    {
        violations.push("the storm has passed and production did not resume".to_owned());
    }
    violations
}

fn of(case: &Case, life: &EndedLife) -> Option<String> {
    let lot = &life.lot;
    match &life.end {
        End::Killed => None,
        End::Hung => Some(format!(
            "{lot} never ended, from {}",
            seconds(life.began_us)
        )),
        End::Failed(why) => Some(format!("{lot} could not go on: {why}")),
        End::Exit(Exit::Done | Exit::Stopped) => None,
        End::Exit(Exit::Trouble(_)) => {
            let named = case.alarms_of(life).next().is_some();
            (!named).then(|| format!("{lot} ended in trouble that no alarm names"))
        }
        End::Exit(other @ (Exit::AnswerIsNo | Exit::BadInput)) => {
            Some(format!("{lot} ended with status {}", other.code()))
        }
    }
}
