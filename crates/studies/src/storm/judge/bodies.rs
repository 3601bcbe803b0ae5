//! Checks that every body lies in the bin that its row names, or that an alarm declares it lost. Checks that every row
//! has a body, and that no body has two rows.
//!
//! The truth of the rig assigns rows to bodies: by the body in the nest at the
//! verdict, and by the body that came to rest in the bin when the beam confirmed the part. A body that clung to another
//! one has no row, because the rig never judged it; the alarm of the beam that counted this body names its bin.

use super::{Case, rig_us, seconds};
use crate::storm::life::{End, EndedLife};
use history::{Alarm, Part};
use rigsim::truth::{BodyTruth, Place};

/// Longest time from a body at rest to its confirmation by the beam, microseconds: it covers the fall, a second body,
/// and repeated polls.
const CONFIRMED_US: u64 = 3_000_000;
/// Time that the fingers take to open, microseconds: a run that ends meanwhile declares the part lost before it falls.
const OPENING_US: u64 = 300_000;
/// Longest time until the reset that detects a lost part, microseconds: the operator may wait this long.
const NOTICED_US: u64 = 60_000_000;
/// Codes of the alarms that declare a part lost.
const DECLARED: [&str; 6] = [
    "part_dropped",
    "part_lost",
    "fall_unseen",
    "bin_beam",
    "part_not_in_nest",
    "gripper_left_end",
];

pub fn violations(case: &Case) -> Vec<String> {
    let (owners, mut violations) = owners(case);
    for (number, body) in case.bodies.iter().enumerate() {
        let rows: Vec<&Part> = owners
            .iter()
            .filter(|(_, owner)| *owner == number)
            .map(|(row, _)| *row)
            .collect();
        let found = misplaced(case, body, &rows)
            .into_iter()
            .chain(recorded_twice(&rows));
        let name = name(body);
        violations.extend(found.map(|what| format!("{name} {what}")));
    }
    violations
}

/// Assigns each row to its body. Returns the rows with the numbers of their bodies, and a message for each row without
/// a body. The bin identifies the body of a landed part, the place at the verdict any other body.
pub fn owners(case: &Case) -> (Vec<(&Part, usize)>, Vec<String>) {
    let (mut owners, mut violations) = (Vec::new(), Vec::new());
    let (landed, other): (Vec<&Part>, Vec<&Part>) =
        case.rows.iter().partition(|row| row.landed_at.is_some());
    for row in landed.into_iter().chain(other) {
        let by_bin = body_by_bin(case, row);
        match by_bin.or_else(|| body_by_place(case, row, &owners)) {
            Some(number) => owners.push((row, number)),
            None => {
                let (kind, seq, lot) = (&row.kind, row.seq, &row.lot);
                violations.push(format!("row {kind} {seq} of {lot} has no body"));
            }
        }
    }
    owners.sort_by_key(|(row, _)| row.time);
    (owners, violations)
}

/// Returns the body that was in the nest or gripper at the verdict and came to rest in the row's bin just before the
/// beam confirmed it.
fn body_by_bin(case: &Case, row: &Part) -> Option<usize> {
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

/// Returns the body that was in the nest at the verdict. For a part without a test, prefers the body in the gripper,
/// unless that body already has a row of the same life.
fn body_by_place(case: &Case, row: &Part, known: &[(&Part, usize)]) -> Option<usize> {
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

fn recorded_twice(rows: &[&Part]) -> Option<String> {
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

fn misplaced(case: &Case, body: &BodyTruth, rows: &[&Part]) -> Option<String> {
    let (at_us, place) = body.path.last()?;
    let landed = rows.iter().find_map(|row| row.landed_bin.as_deref());
    // A run that ends while the fingers open raises its alarm before the body falls.
    let opened_us = let_go_us(body).saturating_sub(OPENING_US);
    match place {
        Place::Bin(bin) if body.clung => (!is_counted(case, let_go_us(body), bin)).then(|| {
            format!(
                "came into {bin} with another one at {} and no alarm declares it",
                seconds(*at_us)
            )
        }),
        Place::Bin(bin) => in_a_bin(case, (opened_us, *at_us), bin, rows),
        Place::Floor if landed.is_some() => Some(format!(
            "lies on the floor since {}, its row says {landed:?}",
            seconds(*at_us)
        )),
        Place::Floor => (!is_declared(case, *at_us)).then(|| {
            format!(
                "lies on the floor since {} and no alarm declares it",
                seconds(*at_us)
            )
        }),
        Place::Pocket | Place::Pusher | Place::Nest | Place::Gripper | Place::Air => {
            Some(format!("was left in {place:?} since {}", seconds(*at_us)))
        }
    }
}

/// Returns the instant at which the body began to fall, microseconds: the life that released it must declare it lost,
/// not a life that began during the fall.
fn let_go_us(body: &BodyTruth) -> u64 {
    let mut falls = body.path.iter().rev();
    let fell = falls.find(|(_, place)| *place == Place::Air);
    fell.or(body.path.last())
        .map_or(0, |(since_us, _)| *since_us)
}

fn in_a_bin(
    case: &Case,
    (opened_us, at_us): (u64, u64),
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
    let named = row.bin.as_deref().unwrap_or_default();
    if named != bin {
        return Some(format!(
            "lies in {bin}, row {} of {} says {named}",
            row.seq, row.lot
        ));
    }
    match row.landed_bin.as_deref() {
        Some(seen) if seen == bin => None,
        Some(seen) => Some(format!("lies in {bin}, was seen in {seen}")),
        None if is_declared(case, opened_us) => None,
        None => Some(format!(
            "lies in {bin} since {}, its row has no landing",
            seconds(at_us)
        )),
    }
}

/// Returns true when an alarm declares the loss at `at_us`: an alarm of the life at that instant, or of a later life up
/// to the first that homed.
fn is_declared(case: &Case, at_us: u64) -> bool {
    has_alarm(case, at_us, |alarm| DECLARED.contains(&alarm.code.as_str()))
}

/// Returns true when an alarm counts a second body in `bin`, or when a kill may have prevented this alarm: a killed
/// life may have confirmed the first body and not yet counted the second.
fn is_counted(case: &Case, at_us: u64, bin: &str) -> bool {
    let confirmed_us = at_us + CONFIRMED_US;
    let opened_us = at_us.saturating_sub(OPENING_US);
    let cut_off = case
        .life_at(at_us)
        .or_else(|| case.life_at(opened_us))
        .is_none_or(|life| life.ended_us < confirmed_us && life.end == End::Killed);
    cut_off
        || has_alarm(case, opened_us, |alarm| {
            alarm.code == "bin_beam" && alarm.args.get("bin") == Some(bin)
        })
}

fn has_alarm(case: &Case, at_us: u64, is_wanted: impl Fn(&Alarm) -> bool) -> bool {
    let noticed_us = at_us + NOTICED_US;
    let is_reported = |life: &EndedLife| {
        let until_us = noticed_us.max(life.began_us + NOTICED_US);
        let mut alarms = case.alarms_of(life);
        alarms.any(|(raised_us, alarm)| (at_us..=until_us).contains(&raised_us) && is_wanted(alarm))
    };
    let own = case
        .life_at(at_us)
        .filter(|life| life.ended_us >= noticed_us);
    let since = case.lives.iter().filter(|life| life.ended_us >= at_us);
    match own {
        Some(life) => is_reported(life),
        None => responsible_lives(case, at_us, since)
            .into_iter()
            .any(is_reported),
    }
}

/// Returns the life at an instant and the lives after it, up to the first later life that judged a part: that life has
/// homed and detected the loss, so that alarms of still later lives have other causes.
fn responsible_lives<'a>(
    case: &Case,
    at_us: u64,
    since: impl Iterator<Item = &'a EndedLife>,
) -> Vec<&'a EndedLife> {
    let has_homed =
        |life: &EndedLife| life.began_us > at_us && case.rows.iter().any(|row| row.lot == life.lot);
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
        (false, true) => "reference part",
        (false, false) => "part",
    };
    let since = body.path.first().map_or(0, |(at, _)| *at);
    format!("the {kind} that left the magazine at {}", seconds(since))
}
