//! The emergency stop pressed at every instant of a cycle, and how long outputs that move something stay on.
//!
//! Every lot is a story (`relayrig story`) in which the stop is pressed again and again, each time a little later after
//! a part has left the nest, released, cleared, reset and started anew. The journal of the simulated rig tells at its
//! terminals when the contact opened and when the last output that moves something went off. The bound is derived
//! from `rig.toml` and holds whatever one transaction meets; so every second lot runs with replies that come at the
//! last moment.

use super::chart::Chart;
use super::figure::{Bar, Figure};
use super::fleet::{Folder, Order};
use super::journal::{self, Entry};
use super::output::Report;
use crate::config::Plant;
use crate::quality::Ordered;
use crate::rig::point::DigitalOut;
use crate::rig::wiring::Wiring;
use std::collections::BTreeMap;
use std::path::Path;

/// Seconds after a part has left the nest over which the stops are spread: a little more than a cycle.
const CYCLE_S: f64 = 2.0;
/// Parts from one stop to the next: two go to retest, and the line is in step again.
const PARTS_BETWEEN: u64 = 5;
/// After a stop nothing is driven for so long, microseconds: the person takes longer to answer.
const QUIET_US: u64 = 2_000_000;
/// Replies of every second lot come so much later, ms: what the allowance of `rig.toml` leaves, but for 3 ms.
const LATE_MS: f64 = 25.0;
/// Classes of the chart.
const CLASSES: usize = 20;

/// One stop.
#[derive(Debug, Clone, Copy)]
struct Stop {
    /// Seconds after a part had left the nest.
    instant_s: f64,
    /// Milliseconds from the contact to the last output off; none when nothing was on.
    reaction_ms: Option<f64>,
}

/// What one lot told.
#[derive(Debug, Default)]
struct Told {
    stops: Vec<Stop>,
    touched: u64,
    unfinished: u64,
}

/// Plays the lots and draws the report up.
///
/// # Errors
/// A configuration that does not load, or a story that could not be played.
pub fn study(order: &Order) -> anyhow::Result<Report> {
    let plant = Plant::load(&order.config)?;
    let bound_ms = plant.wiring.longest_reaction().as_seconds() * 1e3;
    let folder = Folder::new()?;
    let (mut prompt, mut late) = (Told::default(), Told::default());
    let bar = crate::cli::history::progress(order.lots);
    for lot in 0..order.lots {
        let slow = lot % 2 == 1;
        let told = played(order, &folder.0, &plant.wiring, lot, slow)?;
        let all = if slow { &mut late } else { &mut prompt };
        all.stops.extend(told.stops);
        all.touched += told.touched;
        all.unfinished += told.unfinished;
        bar.inc(1);
    }
    bar.finish_and_clear();
    let name = |what: &str| format!("reaction, {what}");
    let late_name = name(&format!("replies {LATE_MS} ms late"));
    Ok(Report {
        study: "stop",
        about: format!(
            "{} stops over {CYCLE_S} s after a part has left the nest",
            order.lots * order.parts
        ),
        groups: vec![
            vec![
                reaction(&name("modules as they are"), &prompt, bound_ms),
                reaction(&late_name, &late, bound_ms),
                Figure::new("bound of rig.toml", 1, Some(bound_ms), "ms"),
            ],
            vec![
                none(
                    "bodies that touched",
                    prompt.touched + late.touched,
                    order.lots,
                ),
                none(
                    "lots that did not go on",
                    prompt.unfinished + late.unfinished,
                    order.lots,
                ),
            ],
        ],
        notes: Vec::new(),
        chart: chart(&prompt, bound_ms),
    })
}

fn reaction(name: &str, told: &Told, bound_ms: f64) -> Figure {
    let times: Vec<f64> = told
        .stops
        .iter()
        .filter_map(|stop| stop.reaction_ms)
        .collect();
    let ordered = Ordered::of(&times);
    Figure::new(name, told.stops.len() as u64, ordered.quantile(1.0), "ms")
        .with("median", ordered.quantile(0.5))
        .with("p99", ordered.quantile(0.99))
        .with("outputs_were_on", Some(times.len() as f64))
        .bar(Bar::AtMost(bound_ms))
}

fn none(name: &str, count: u64, of: u64) -> Figure {
    Figure::count(name, of, Some(count)).bar(Bar::AtMost(0.0))
}

/// Worst reaction by the instant in the cycle.
fn chart(told: &Told, bound_ms: f64) -> Chart {
    let width = CYCLE_S / CLASSES as f64;
    let worst = |class: usize| {
        let inside = told
            .stops
            .iter()
            .filter(|stop| (stop.instant_s / width) as usize == class);
        inside.filter_map(|stop| stop.reaction_ms).reduce(f64::max)
    };
    Chart {
        title: "worst reaction to the emergency stop by the instant after a part has left the nest"
            .into(),
        unit: "ms",
        from: 0.0,
        marks: vec![bound_ms],
        bars: (0..CLASSES)
            .map(|class| (format!("{:.1} s", class as f64 * width), worst(class)))
            .collect(),
    }
}

/// When the stops of a lot are pressed, seconds after a part has left; lots lie between each other.
fn instants(order: &Order, lot: u64) -> Vec<f64> {
    let all = (order.lots * order.parts) as f64;
    let instant = |stop: u64| CYCLE_S * (stop * order.lots + lot) as f64 / all;
    (0..order.parts).map(instant).collect()
}

fn script(instants: &[f64], slow: bool) -> String {
    let mut text = format!(
        "# Emergency stops\nparts {}\n",
        (instants.len() as u64 + 1) * PARTS_BETWEEN
    );
    if slow {
        text += &format!("fault delay={LATE_MS}\n");
    }
    for (part, instant) in (1..).map(|stop| stop * PARTS_BETWEEN).zip(instants) {
        text += &format!(
            "after left {part} +{instant:.4} fault estop\nafter state Aborted +4 order clear\n\
             after state Stopped order reset\nafter state Idle order start\n"
        );
    }
    text
}

fn played(
    order: &Order,
    folder: &Path,
    wiring: &Wiring,
    lot: u64,
    slow: bool,
) -> anyhow::Result<Told> {
    let instants = instants(order, lot);
    let played = journal::play(order, folder, &script(&instants, slow), lot + 1)?;
    let reactions = reactions(&played.entries, &moving(wiring));
    let stops = instants.iter().zip(reactions);
    Ok(Told {
        stops: stops
            .map(|(instant_s, reaction_ms)| Stop {
                instant_s: *instant_s,
                reaction_ms,
            })
            .collect(),
        touched: played.text.matches("BODIES TOUCHED").count() as u64,
        unfinished: u64::from(!played.whole),
    })
}

/// Bits that move something, by module.
fn moving(wiring: &Wiring) -> BTreeMap<String, u16> {
    let mut bits = BTreeMap::new();
    for point in DigitalOut::ALL.iter().filter(|point| point.moves()) {
        let terminal = wiring.digital_out(*point);
        *bits
            .entry(wiring.module(terminal.module).name.clone())
            .or_insert(0) |= terminal.bit();
    }
    bits
}

/// For every stop the time until the last output that moves something was off, milliseconds; none when none was on.
fn reactions(entries: &[Entry], moving: &BTreeMap<String, u16>) -> Vec<Option<f64>> {
    let mut on: BTreeMap<&str, u16> = BTreeMap::new();
    let mut reactions: Vec<Option<f64>> = Vec::new();
    let mut pressed_us = None;
    for entry in entries {
        match entry {
            Entry::Struck { t_us, fault } if fault == "estop" => {
                pressed_us = Some(*t_us);
                let any = on.values().any(|bits| *bits != 0);
                // What is never switched off counts as long as anybody waits.
                reactions.push(any.then_some(QUIET_US as f64 / 1e3));
            }
            Entry::Output { t_us, module, bits } => {
                let Some(mask) = moving.get(module) else {
                    continue;
                };
                let was = on.insert(module, bits & mask).unwrap_or(0);
                let all_off = on.values().all(|bits| *bits == 0);
                let since_us = pressed_us
                    .map(|pressed| t_us - pressed)
                    .filter(|us| *us < QUIET_US);
                if let (Some(us), Some(last)) = (since_us, reactions.last_mut())
                    && (was | (bits & mask)) != 0
                {
                    *last = Some(if all_off {
                        us as f64 / 1e3
                    } else {
                        QUIET_US as f64 / 1e3
                    });
                }
            }
            Entry::Struck { .. } | Entry::Expired {} => {}
        }
    }
    reactions
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(entries: &[Entry]) -> Vec<Option<f64>> {
        reactions(
            entries,
            &BTreeMap::from([("valves".to_owned(), 0x00FF), ("axis".to_owned(), 0x000F)]),
        )
    }

    fn output(t_us: u64, module: &str, bits: u16) -> Entry {
        Entry::Output {
            t_us,
            module: module.into(),
            bits,
        }
    }

    fn estop(t_us: u64) -> Entry {
        Entry::Struck {
            t_us,
            fault: "estop".into(),
        }
    }

    #[test]
    fn a_reaction_ends_with_the_last_output_that_moves_something() {
        let entries = [
            output(0, "valves", 0x0102),
            output(0, "axis", 0x0008),
            estop(1_000_000),
            output(1_010_000, "valves", 0x0106),
            output(1_030_000, "axis", 0x0100),
            output(1_040_000, "valves", 0x0100),
            output(5_000_000, "valves", 0x0002),
        ];
        assert_eq!(told(&entries), [Some(40.0)]);
    }

    #[test]
    fn nothing_on_is_no_reaction_and_what_stays_on_is_the_longest() {
        assert_eq!(told(&[output(0, "valves", 0x0100), estop(10)]), [None]);
        assert_eq!(
            told(&[output(0, "valves", 0x0001), estop(10)]),
            [Some(2000.0)]
        );
        let again = [
            output(0, "valves", 1),
            estop(10),
            output(1_010, "valves", 0),
            output(2_010, "valves", 2),
        ];
        assert_eq!(told(&again), [Some(2000.0)]);
    }
}
