//! Checks that contactors open: within the time of the host watchdog after a kill or the end of a life, and within the
//! reaction of the rig to a safety input. A contactor that a fault has welded may open later, when the fault ends.

use super::{Case, seconds};
use std::ops::Range;

/// Longest time from a coil without current to open main contacts, microseconds.
const RELEASE_US: u64 = 10_000;

/// Time in which a contactor is closed, microseconds.
struct Closed {
    contactor: &'static str,
    us: Range<u64>,
}

pub fn violations(case: &Case) -> Vec<String> {
    let all = closed(case);
    let open = must_be_open(case);
    let of = |(us, why): &(Range<u64>, String)| {
        let during = |it: &&Closed| it.us.start < us.end && us.start < it.us.end;
        let found = all
            .iter()
            .find(|it| during(it) && !is_welded(case, it, us))?;
        let contactor = found.contactor;
        Some(format!("{contactor} was closed {why}"))
    };
    open.iter().filter_map(of).collect()
}

/// Returns the times in which each contactor was closed.
fn closed(case: &Case) -> Vec<Closed> {
    let mut all: Vec<Closed> = Vec::new();
    for it in &case.contact_moves {
        let mut open = all.iter_mut().rev();
        let own = open.find(|known| known.contactor == it.contactor && known.us.end == u64::MAX);
        match (own, it.closed) {
            (Some(known), false) => known.us.end = it.t_us,
            (None, true) => all.push(Closed {
                contactor: it.contactor,
                us: it.t_us..u64::MAX,
            }),
            (Some(_), true) | (None, false) => {}
        }
    }
    all
}

/// Returns true when a contactor that was closed in a time in which it had to be open was welded at the begin of that time,
/// and has opened after its fault.
fn is_welded(case: &Case, closed: &Closed, open: &Range<u64>) -> bool {
    let ends_us = |at_us: u64| at_us + case.hold_us + RELEASE_US;
    let explains =
        |at_us: &u64| *at_us < open.start.max(closed.us.start) && closed.us.end <= ends_us(*at_us);
    case.welded_us.iter().any(explains)
}

/// Returns the times in which all contactors must be open, and the reason of each.
fn must_be_open(case: &Case) -> Vec<(Range<u64>, String)> {
    let reaction = match case.lines_disturbed {
        true => case.reaction_in_trouble,
        false => case.reaction,
    };
    let disturbed = case.disturbed_us.iter().map(|at_us| {
        let from_us = at_us + reaction.0 + RELEASE_US;
        let why = format!("while a safety input was open since {}", seconds(*at_us));
        (from_us..at_us + case.hold_us, why)
    });
    let lives = case.lives.iter().enumerate().map(|(number, life)| {
        let next_us = case
            .lives
            .get(number + 1)
            .map_or(u64::MAX, |it| it.began_us);
        let from_us = life.ended_us + case.watchdog.0 + RELEASE_US;
        let why = format!(
            "after the end of {} at {}",
            life.lot,
            seconds(life.ended_us)
        );
        (from_us.min(next_us)..next_us, why)
    });
    let all = disturbed.chain(lives);
    all.filter(|(us, _)| !us.is_empty()).collect()
}
