//! Every life ends by itself unless it was killed, a trouble has its name in the history, and when faults cease
//! production resumes: the last life is calm and completes its lot.

use super::{Case, seconds};
use crate::storm::life::{End, Lived};
use app::exit::Exit;

pub fn broken(case: &Case) -> Vec<String> {
    let mut broken: Vec<String> = case
        .lives
        .iter()
        .filter_map(|life| of(case, life))
        .collect();
    if case
        .lives
        .last()
        .is_none_or(|life| life.end != End::Exit(Exit::Done))
    {
        broken.push("the storm has passed and production did not resume".to_owned());
    }
    broken
}

fn of(case: &Case, life: &Lived) -> Option<String> {
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
