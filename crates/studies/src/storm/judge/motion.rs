//! Checks that no driven motion begins while a safety input is open, between an abort and the next reset, or without a
//! running controller. Motions by springs and gravity do not count.

use super::{Case, seconds};
use crate::storm::life::End;
use std::ops::Range;

/// An interval in which no driven motion may begin, microseconds, and the reason why.
struct StillInterval {
    us: Range<u64>,
    why: String,
}

pub fn violations(case: &Case) -> Vec<String> {
    let still_intervals = still_intervals(case);
    let of = |still: &StillInterval| {
        let mut driven = case.driven.iter();
        let (at_us, what) = driven.find(|(at_us, _)| still.us.contains(at_us))?;
        Some(format!(
            "{what} was driven at {} {}",
            seconds(*at_us),
            still.why
        ))
    };
    still_intervals.iter().filter_map(of).collect()
}

fn still_intervals(case: &Case) -> Vec<StillInterval> {
    let reaction = if case.lines_disturbed {
        case.reaction_in_trouble
    } else {
        case.reaction
    };
    let mut still_intervals = Vec::new();
    for at_us in &case.disturbed_us {
        still_intervals.push(StillInterval {
            us: at_us + reaction.0..at_us + case.hold_us,
            why: format!("while a safety input was open since {}", seconds(*at_us)),
        });
    }
    for (n, life) in case.lives.iter().enumerate() {
        let next_us = case.lives.get(n + 1).map_or(u64::MAX, |next| next.began_us);
        let grace_us = match life.end {
            End::Killed | End::Failed(_) | End::Hung => case.reaction_in_trouble.0,
            End::Exit(_) if case.lines_disturbed => case.reaction_in_trouble.0,
            End::Exit(_) => 0,
        };
        still_intervals.push(StillInterval {
            us: (life.ended_us + grace_us).min(next_us)..next_us,
            why: format!(
                "after the end of {} at {}",
                life.lot,
                seconds(life.ended_us)
            ),
        });
        for (place, answers) in life.answers.iter().enumerate() {
            if answers.order != "abort" || answers.refused.is_some() {
                continue;
            }
            let again = life.answers[place..]
                .iter()
                .find(|later| later.order == "reset" && later.refused.is_none());
            let until = again.map_or(life.ended_us, |reset| life.began_us + reset.at.0);
            let from = life.began_us + answers.at.0 + reaction.0;
            still_intervals.push(StillInterval {
                us: from..until.max(from),
                why: format!(
                    "after the abort ordered at {}",
                    seconds(life.began_us + answers.at.0)
                ),
            });
        }
    }
    still_intervals
}
