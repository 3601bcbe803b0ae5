//! Nothing is driven after a stop: not while a safety input is open, not after an abort before the next reset, not
//! without a controller. Springs and gravity are no drive.

use super::{Case, seconds};
use crate::storm::life::End;
use crate::storm::weather::DISTURBED_US;
use std::ops::Range;

/// A span in which nothing may be driven, and why.
struct Still {
    us: Range<u64>,
    why: String,
}

pub fn broken(case: &Case) -> Vec<String> {
    let stills = stills(case);
    let of = |still: &Still| {
        let mut driven = case.driven.iter();
        let (at_us, what) = driven.find(|(at_us, _)| still.us.contains(at_us))?;
        Some(format!(
            "{what} was driven at {} {}",
            seconds(*at_us),
            still.why
        ))
    };
    stills.iter().filter_map(of).collect()
}

fn stills(case: &Case) -> Vec<Still> {
    let reaction = if case.lines_suffer {
        case.reaction_in_trouble
    } else {
        case.reaction
    };
    let mut stills = Vec::new();
    for at_us in &case.disturbed_us {
        stills.push(Still {
            us: at_us + reaction.0..at_us + DISTURBED_US,
            why: format!("while a safety input was open since {}", seconds(*at_us)),
        });
    }
    for (n, life) in case.lives.iter().enumerate() {
        let next_us = case.lives.get(n + 1).map_or(u64::MAX, |next| next.began_us);
        let grace_us = match life.end {
            End::Killed | End::Failed(_) | End::Hung => case.reaction_in_trouble.0,
            End::Exit(_) if case.lines_suffer => case.reaction_in_trouble.0,
            End::Exit(_) => 0,
        };
        stills.push(Still {
            us: (life.ended_us + grace_us).min(next_us)..next_us,
            why: format!(
                "after the end of {} at {}",
                life.lot,
                seconds(life.ended_us)
            ),
        });
        for (place, said) in life.said.iter().enumerate() {
            if said.order != "abort" || said.refused.is_some() {
                continue;
            }
            let again = life.said[place..]
                .iter()
                .find(|later| later.order == "reset" && later.refused.is_none());
            let until = again.map_or(life.ended_us, |reset| life.began_us + reset.at.0);
            let from = life.began_us + said.at.0 + reaction.0;
            stills.push(Still {
                us: from..until.max(from),
                why: format!(
                    "after the abort ordered at {}",
                    seconds(life.began_us + said.at.0)
                ),
            });
        }
    }
    stills
}
