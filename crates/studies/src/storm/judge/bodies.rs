//! Every body lies in the one bin that its row names, or an alarm declared it lost; no row without a body, none
//! twice. Which row is whose is found by the rig's truth: who stood in the nest when it was judged, who came to
//! rest in the bin when it was seen. A body that clung to another one was never judged: it has no row, and the alarm of
//! the beam that counted it says which bin it lies in.

use super::{Case, rig_us, seconds};
use crate::storm::life::{End, Lived};
use history::{Alarm, Part};
use rigsim::truth::{BodyTruth, Place};

/// From a body at rest to its confirmation by the beam: fall, second body, polls and repeated polls, microseconds.
const CONFIRMED_US: u64 = 3_000_000;
/// The fingers take so long to open, microseconds: a run that ends meanwhile tells of the part before it falls.
const OPENING_US: u64 = 300_000;
/// A part that is gone is noticed at the latest at the reset after it, microseconds; a person may take this long.
const NOTICED_US: u64 = 60_000_000;
/// A part is gone: what says so.
const DECLARED: [&str; 6] = [
    "part_dropped",
    "part_lost",
    "fall_unseen",
    "bin_beam",
    "part_not_in_nest",
    "gripper_left_end",
];

pub fn broken(case: &Case) -> Vec<String> {
    let (owners, mut broken) = owners(case);
    for (number, body) in case.bodies.iter().enumerate() {
        let rows: Vec<&Part> = owners
            .iter()
            .filter(|(_, owner)| *owner == number)
            .map(|(row, _)| *row)
            .collect();
        let found = fate(case, body, &rows).into_iter().chain(twice(&rows));
        let name = name(body);
        broken.extend(found.map(|what| format!("{name} {what}")));
    }
    broken
}

/// Rows with the number of their body, and rows that have none. Who landed is told by the bin, the others by the
/// place where they were judged.
pub fn owners(case: &Case) -> (Vec<(&Part, usize)>, Vec<String>) {
    let (mut owners, mut broken) = (Vec::new(), Vec::new());
    let (landed, other): (Vec<&Part>, Vec<&Part>) =
        case.rows.iter().partition(|row| row.landed_at.is_some());
    for row in landed.into_iter().chain(other) {
        let by_bin = who_landed(case, row);
        match by_bin.or_else(|| who_was_judged(case, row, &owners)) {
            Some(number) => owners.push((row, number)),
            None => {
                let (kind, seq, lot) = (&row.kind, row.seq, &row.lot);
                broken.push(format!("row {kind} {seq} of {lot} is nobody's"));
            }
        }
    }
    owners.sort_by_key(|(row, _)| row.time);
    (owners, broken)
}

/// The body that came to rest in the bin just before its beam was believed, if it was inside when the row was judged.
fn who_landed(case: &Case, row: &Part) -> Option<usize> {
    let (bin, seen_us) = (row.landed_bin.as_deref()?, rig_us(row.landed_at?));
    let judged_us = rig_us(row.time);
    let inside = |body: &BodyTruth| {
        matches!(body.at(judged_us), Some(Place::Nest | Place::Gripper)) && !body.clung
    };
    let fell = |body: &BodyTruth| match body.path.last() {
        Some((at_us, Place::Bin(own))) => {
            own == bin && (*at_us..at_us + CONFIRMED_US).contains(&seen_us)
        }
        _ => false,
    };
    let mut all = case.bodies.iter().enumerate();
    all.rfind(|(_, body)| fell(body) && inside(body))
        .map(|(number, _)| number)
}

/// A test is judged in the nest. What was never tested may have been found between the fingers: then it had no row
/// in this life, and the one in the nest waits for its own.
fn who_was_judged(case: &Case, row: &Part, known: &[(&Part, usize)]) -> Option<usize> {
    let judged_us = rig_us(row.time);
    let at = |place: &Place| {
        let mut all = case.bodies.iter();
        all.position(|body| body.at(judged_us) == Some(place) && !body.clung)
    };
    let free = |number: &usize| {
        let own = |(other, owner): &(&Part, usize)| owner == number && other.lot == row.lot;
        !known.iter().any(own)
    };
    let (nest, gripper) = (at(&Place::Nest), at(&Place::Gripper));
    if row.test_s.is_some() {
        return nest;
    }
    let first = gripper.filter(free).or(nest.filter(free));
    first.or(nest).or(gripper)
}

fn twice(rows: &[&Part]) -> Option<String> {
    let landed: Vec<&str> = rows
        .iter()
        .filter(|row| row.landed_bin.is_some())
        .map(|row| row.lot.as_str())
        .collect();
    let mut lots: Vec<&str> = rows.iter().map(|row| row.lot.as_str()).collect();
    lots.dedup();
    if lots.len() < rows.len() {
        return Some(format!("has {} rows in {lots:?}", rows.len()));
    }
    (landed.len() > 1).then(|| format!("landed {} times: {landed:?}", landed.len()))
}

fn fate(case: &Case, body: &BodyTruth, rows: &[&Part]) -> Option<String> {
    let (at_us, place) = body.path.last()?;
    let landed = rows.iter().find_map(|row| row.landed_bin.as_deref());
    match place {
        Place::Bin(bin) if body.clung => (!is_counted(case, let_go_us(body), bin)).then(|| {
            format!(
                "came into {bin} with another one at {} and no alarm says so",
                seconds(*at_us)
            )
        }),
        Place::Bin(bin) => in_a_bin(case, (let_go_us(body), *at_us), bin, rows),
        Place::Floor if landed.is_some() => Some(format!(
            "lies on the floor since {}, its row says {landed:?}",
            seconds(*at_us)
        )),
        Place::Floor => (!is_declared(case, *at_us)).then(|| {
            format!(
                "lies on the floor since {} and no alarm says so",
                seconds(*at_us)
            )
        }),
        Place::Pocket | Place::Pusher | Place::Nest | Place::Gripper | Place::Air => {
            Some(format!("was left in {place:?} since {}", seconds(*at_us)))
        }
    }
}

/// When it began to fall: whoever let it go has to tell what became of it, not who came while it fell.
fn let_go_us(body: &BodyTruth) -> u64 {
    let mut falls = body.path.iter().rev();
    let fell = falls.find(|(_, place)| *place == Place::Air);
    fell.or(body.path.last())
        .map_or(0, |(since_us, _)| *since_us)
}

fn in_a_bin(
    case: &Case,
    (let_go_us, at_us): (u64, u64),
    bin: &str,
    rows: &[&Part],
) -> Option<String> {
    let mut earlier = rows.iter().filter(|row| rig_us(row.time) <= at_us);
    let Some(row) = earlier.next_back() else {
        return Some(format!(
            "lies in {bin} since {} without a row",
            seconds(at_us)
        ));
    };
    let asked = row.bin.as_deref().unwrap_or_default();
    if asked != bin {
        return Some(format!(
            "lies in {bin}, row {} of {} says {asked}",
            row.seq, row.lot
        ));
    }
    match row.landed_bin.as_deref() {
        Some(seen) if seen == bin => None,
        Some(seen) => Some(format!("lies in {bin}, was seen in {seen}")),
        None if is_declared(case, let_go_us.saturating_sub(OPENING_US)) => None,
        None => Some(format!(
            "lies in {bin} since {}, its row does not know it",
            seconds(at_us)
        )),
    }
}

/// An alarm of the life in which it happened tells it, or of the ones that came after until one had homed.
fn is_declared(case: &Case, at_us: u64) -> bool {
    is_told(case, at_us, |alarm| DECLARED.contains(&alarm.code.as_str()))
}

/// The same of a body that fell into a bin beside the one that was let go: the alarm names the bin. A life that was cut
/// off may have confirmed the first one and not have heard of the second.
fn is_counted(case: &Case, at_us: u64, bin: &str) -> bool {
    let confirmed_us = at_us + CONFIRMED_US;
    let cut_off = case
        .life_at(at_us)
        .is_none_or(|life| life.ended_us < confirmed_us && life.end == End::Killed);
    cut_off
        || is_told(case, at_us, |alarm| {
            alarm.code == "bin_beam" && alarm.args.get("bin") == Some(bin)
        })
}

fn is_told(case: &Case, at_us: u64, tells: impl Fn(&Alarm) -> bool) -> bool {
    let noticed_us = at_us + NOTICED_US;
    let told = |life: &Lived| {
        let until_us = noticed_us.max(life.began_us + NOTICED_US);
        let mut alarms = case.alarms_of(life);
        alarms.any(|(raised_us, alarm)| (at_us..=until_us).contains(&raised_us) && tells(alarm))
    };
    let own = case
        .life_at(at_us)
        .filter(|life| life.ended_us >= noticed_us);
    let since = case.lives.iter().filter(|life| life.ended_us >= at_us);
    match own {
        Some(life) => told(life),
        None => whose_turn(case, at_us, since).into_iter().any(told),
    }
}

/// The life in which something happened, and those after it up to the first that has judged a part: that one has homed
/// and seen what is gone, so whatever a later one tells is something else.
fn whose_turn<'a>(
    case: &Case,
    at_us: u64,
    since: impl Iterator<Item = &'a Lived>,
) -> Vec<&'a Lived> {
    let has_homed =
        |life: &Lived| life.began_us > at_us && case.rows.iter().any(|row| row.lot == life.lot);
    let mut turns = Vec::new();
    for life in since {
        turns.push(life);
        if has_homed(life) {
            break;
        }
    }
    turns
}

fn name(body: &BodyTruth) -> String {
    let kind = match (body.clung, body.is_reference) {
        (true, _) => "second body",
        (false, true) => "golden part",
        (false, false) => "part",
    };
    let since = body.path.first().map_or(0, |(at, _)| *at);
    format!("the {kind} that left the magazine at {}", seconds(since))
}
