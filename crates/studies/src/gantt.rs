//! A Gantt chart as SVG of one part through all stations, with its neighbours: the intervals in which each output was
//! on.
//!
//! The intervals come from the journal of the simulated rig, at the terminals of the actuators. The followed part is
//! drawn dark.

use super::journal::{self, Entry};
use super::order::Order;
use anyhow::Context;
use config::Plant;
use history::report::svg::Svg;
use machine::dut::em_relay;
use machine::rig::point::DigitalOut;
use machine::rig::wiring::Wiring;
use tempfile::TempDir;

/// Script of a lot with parts before and after the followed part.
const SCRIPT: &str = "# A chart of one part\nparts 8\n";
/// Number of parts behind the followed one.
const BEHIND: usize = 3;

/// Rows of the chart from top to bottom: label, and outputs; a row is on while at least one of its outputs is on.
const ROWS: [(&str, &[&str]); 8] = [
    ("escapement open", &[DigitalOut::EscapementRelease.name()]),
    ("pusher at the nest", &[DigitalOut::PusherExtend.name()]),
    ("jaws closed", &[DigitalOut::ClampClose.name()]),
    ("probes up", &[DigitalOut::ProbeLift.name()]),
    (
        "coil driven",
        &[em_relay::points::DigitalOut::CoilDrive.name()],
    ),
    ("z down", &[DigitalOut::SortZLower.name()]),
    ("fingers closed", &[DigitalOut::GripperClose.name()]),
    (
        "axis away",
        &[
            DigitalOut::AxisPoint0.name(),
            DigitalOut::AxisPoint1.name(),
            DigitalOut::AxisPoint2.name(),
        ],
    ),
];
/// Index in [`ROWS`] of the coil, which a test drives several times.
const COIL: usize = 4;
/// Index in [`ROWS`] of the probes.
const PROBES: usize = 3;

const LABEL: f64 = 150.0;
const PLOT: f64 = 760.0;
const TOP: f64 = 44.0;
const ROW: f64 = 26.0;

/// Start and end of an interval, seconds.
type Interval = (f64, f64);

/// Plays a lot and draws one part of it as SVG.
///
/// # Errors
/// Fails when a lot cannot be run, or when no part of it goes through all stations.
pub fn svg(order: &Order) -> anyhow::Result<String> {
    let plant = Plant::load(&order.folder())?;
    let folder = TempDir::new()?;
    let played = journal::play(order, folder.path(), SCRIPT, 1)?;
    let rows = ROWS.map(|(_, outputs)| intervals(&played.entries, &plant.wiring, outputs));
    let followed = followed(&rows).context("the chart: no part went through all stations")?;
    Ok(drawn(&rows, &followed))
}

/// Returns the intervals in which at least one of these outputs was on.
fn intervals(entries: &[Entry], wiring: &Wiring, outputs: &[&str]) -> Vec<Interval> {
    let terminals: Vec<_> = outputs
        .iter()
        .filter_map(|name| wiring.digital_output(name))
        .map(|output| wiring.digital_out(output))
        .collect();
    let (mut since, mut intervals) = (None, Vec::new());
    for entry in entries {
        let Entry::Output { t_us, module, bits } = entry else {
            continue;
        };
        let mut own = terminals
            .iter()
            .filter(|it| wiring.module(it.module).name == *module)
            .peekable();
        if own.peek().is_none() {
            continue;
        }
        let (now, is_on) = (*t_us as f64 * 1e-6, own.any(|it| bits & it.bit() != 0));
        match (since, is_on) {
            (None, true) => since = Some(now),
            (Some(from), false) => {
                intervals.push((from, now));
                since = None;
            }
            (None, false) | (Some(_), true) => {}
        }
    }
    intervals
}

/// Returns the interval of each row that belongs to the followed part.
fn followed(rows: &[Vec<Interval>; 8]) -> Option<[Interval; 8]> {
    let before = |row: usize, at: f64| rows[row].iter().rev().find(|it| it.0 < at).copied();
    let after = |row: usize, at: f64| rows[row].iter().find(|it| it.0 >= at).copied();
    let probes = *rows[PROBES].iter().rev().nth(BEHIND)?;
    let jaws = before(2, probes.0)?;
    let pusher = before(1, jaws.0)?;
    let escapement = before(0, pusher.0)?;
    let z = after(5, pusher.0)?;
    let fingers = after(6, z.0)?;
    let axis = after(7, fingers.0)?;
    Some([escapement, pusher, jaws, probes, probes, z, fingers, axis])
}

fn drawn(rows: &[Vec<Interval>; 8], followed: &[Interval; 8]) -> String {
    let (from, to) = (followed[0].0 - 0.2, followed[7].1 + 0.2);
    let x = |at: f64| LABEL + PLOT * (at.clamp(from, to) - from) / (to - from);
    let height = TOP + ROW * rows.len() as f64 + 30.0;
    let mut svg = Svg::new([LABEL + PLOT + 20.0, height]);
    let mut second = 0.0;
    while from + second <= to {
        let x = x(from + second);
        svg.line([x, TOP], [x, height - 26.0], "stroke=\"#ccc\"");
        svg.text([x, height - 10.0], "", &format!("{second:.1}"));
        second += 0.5;
    }
    for (place, ((label, _), intervals)) in ROWS.iter().zip(rows).enumerate() {
        let y = TOP + ROW * place as f64;
        svg.text([10.0, y + 16.0], "", label);
        for it in intervals.iter().filter(|it| it.1 > from && it.0 < to) {
            let own = match place {
                COIL => it.0 >= followed[COIL].0 && it.1 <= followed[COIL].1,
                _ => *it == followed[place],
            };
            let fill = if own { "#1f4e79" } else { "#b8cce4" };
            let size = [(x(it.1) - x(it.0)).max(1.0), 18.0];
            svg.rect([x(it.0), y + 3.0], size, fill);
        }
    }
    svg.file("one part through all stations, seconds; its neighbours are light")
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_part_is_followed_from_escapement_to_bin() {
        let cycle = |n: f64| [0.0, 1.8, 2.1, 2.4, 2.5, 2.6, 3.3, 3.9].map(|at| at + 2.0 * n);
        let long = |row: usize| if row == PROBES { 0.4 } else { 0.1 };
        let rows: [Vec<Interval>; 8] = std::array::from_fn(|row| {
            let starts = (0..6).map(|n| cycle(f64::from(n))[row]);
            starts.map(|at| (at, at + long(row))).collect()
        });
        let part = followed(&rows).unwrap();
        let starts = part.map(|it| it.0);
        let expected = cycle(2.0);
        for row in (0..8).filter(|row| *row != COIL) {
            assert!((starts[row] - expected[row]).abs() < 1e-9, "{starts:?}");
        }
        let picture = drawn(&rows, &part);
        assert!(
            picture.contains("jaws closed") && picture.matches("#1f4e79").count() == 8,
            "{picture}"
        );
    }
}
