//! The trace of a seed, as lines in order of time: lives, orders with their answers, alarms, rows, and paths of the
//! bodies.

use super::judge::{Case, rig_us, seconds};

/// Number of last lines of a trace that a report shows.
const LAST: usize = 40;

/// Returns all lines of a trace.
pub fn lines(case: &Case) -> Vec<String> {
    let mut lines: Vec<(u64, String)> = Vec::new();
    for life in &case.lives {
        lines.push((life.began_us, format!("{} begins", life.lot)));
        lines.push((life.ended_us, format!("{} ends: {:?}", life.lot, life.end)));
        lines.extend(life.answers.iter().map(|answers| {
            let answer = answers.refused.as_deref().unwrap_or("taken");
            let at_us = life.began_us + answers.at.0;
            (
                at_us,
                format!("{} in {}: {answer}", answers.order, answers.state),
            )
        }));
    }
    for alarm in &case.alarms {
        lines.push((
            rig_us(alarm.raised),
            format!("alarm {}: {}", alarm.code, alarm.text),
        ));
    }
    for row in &case.rows {
        let name = format!("{} {} of {}", row.kind, row.seq, row.lot);
        let bin = row.bin.as_deref().unwrap_or("nowhere");
        let values = serde_json::Value::Object(row.values.clone());
        let verdict = format!(
            "{name} judged {} for {bin} {:?} {values}",
            row.verdict, row.reasons
        );
        lines.push((rig_us(row.time), verdict));
        if let (Some(at), Some(bin)) = (row.landed_at, &row.landed_bin) {
            lines.push((rig_us(at), format!("{name} seen in {bin}")));
        }
    }
    for (number, body) in case.bodies.iter().enumerate() {
        let defect = body.part.defect.unwrap_or("good");
        let way = |(at, place): &(u64, _)| (*at, format!("body {number} ({defect}): {place:?}"));
        lines.extend(body.path.iter().map(way));
    }
    let driven = case.driven.iter();
    lines.extend(driven.map(|(at, what)| (*at, format!("{what} driven"))));
    lines.sort_by_key(|(at, _)| *at);
    let text = |(at, what): (u64, String)| format!("{:>12} {what}", seconds(at));
    lines.into_iter().map(text).collect()
}

/// Returns the last lines of a trace.
pub fn last(lines: &[String]) -> &[String] {
    &lines[lines.len().saturating_sub(LAST)..]
}

/// Returns the FNV-1a hash of all bytes; equal traces have equal digests.
pub fn digest(lines: impl IntoIterator<Item = impl AsRef<[u8]>>) -> u64 {
    let hash = |hash: u64, line: &[u8]| {
        line.iter().fold(hash, |hash, byte| {
            (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01B3)
        })
    };
    let lines = lines.into_iter();
    lines.fold(0xCBF2_9CE4_8422_2325, |sum, line| hash(sum, line.as_ref()))
}
