//! Every fault of the chamber at random instants: how long the heater stays on, and what becomes of the parts.
//!
//! A fault counts only when the command of the heater was on at the instant of the fault or came on later. The time
//! counts from the fault; for an open heater, which nothing shows and which does nothing without power, from the first
//! command after it. Parts that were judged before the fault do not count.

use super::heat;
use super::program::{Lot, Ran, run};
use crate::dice::Dice;
use crate::figure::{Bar, Figure};
use crate::pool::{self, LOTS_AT_ONCE};
use crate::storm::life::{EPOCH_US, End};
use app::exit::Exit;

/// Recipe of the lots.
const RECIPE: &str = "thermostat-ksd9700";
/// Number of parts of a lot.
const PARTS: u64 = 6;
/// Instants between which a fault strikes, s: from the first heat of the identification to the last descent.
const INSTANTS_S: [u64; 2] = [420, 3_000];
/// Longest time for which the heater may stay on after a fault that a sensor or the safety chain shows, s.
const SHOWN_S: f64 = 2.0;
/// The same after a fault that only the temperatures show, s.
const HIDDEN_S: f64 = 60.0;

/// What must follow a fault.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Must {
    /// The heater is off within this time, s, and no part is judged.
    Stop(f64),
    /// The same within this time, s, of the first command of the heater.
    StopOncePowered(f64),
    /// Either the heater ends off, or the results stay right because the controller makes up for the fault.
    StopOrStayRight,
}

/// Faults with what must follow.
const FAULTS: [(&str, Must); 22] = [
    ("control_open", Must::Stop(SHOWN_S)),
    ("control_short", Must::Stop(SHOWN_S)),
    ("reference_open", Must::Stop(SHOWN_S)),
    ("reference_short", Must::Stop(SHOWN_S)),
    ("silence=rtd", Must::Stop(SHOWN_S)),
    ("limiter", Must::Stop(SHOWN_S)),
    ("door", Must::Stop(SHOWN_S)),
    ("estop", Must::Stop(SHOWN_S)),
    ("mains_off", Must::Stop(SHOWN_S)),
    ("fan_stopped", Must::Stop(HIDDEN_S)),
    ("heater_open", Must::StopOncePowered(HIDDEN_S)),
    ("ssr_stuck", Must::Stop(HIDDEN_S)),
    ("control_stuck", Must::StopOrStayRight),
    ("reference_stuck", Must::StopOrStayRight),
    ("control_drift", Must::StopOrStayRight),
    ("reference_drift", Must::StopOrStayRight),
    ("heater_half", Must::StopOrStayRight),
    ("fan_slow", Must::StopOrStayRight),
    ("vent_stuck", Must::StopOrStayRight),
    ("mains_low", Must::StopOrStayRight),
    ("thermocouple_open", Must::StopOrStayRight),
    ("rack_open", Must::StopOrStayRight),
];

/// A fault at one instant.
struct Struck {
    /// Place of the fault in [`FAULTS`].
    which: usize,
    seed: u64,
    at_s: u64,
    ran: Ran,
}

impl Struck {
    /// Returns the time until the last instant at which the command of the heater was on after the fault, s; `None` when
    /// it was never on.
    fn heats_s(&self, must: Must) -> Option<f64> {
        let at_us = self.at_s * 1_000_000;
        let heated = heat::heated(&self.ran.journal).into_iter();
        let after: Vec<_> = heated.filter(|it| it.end > at_us).collect();
        let from_us = match must {
            Must::Stop(_) | Must::StopOrStayRight => at_us,
            Must::StopOncePowered(_) => after.first()?.start.max(at_us),
        };
        Some((after.last()?.end - from_us) as f64 / 1e6)
    }

    /// Returns true when an alarm has ended the lot.
    fn is_seen(&self) -> bool {
        self.ran.end != End::Exit(Exit::Done)
    }

    /// Returns three counts of parts judged after the fault: all of them, those with another verdict than void, good
    /// parts that failed beyond their guard band.
    fn judged(&self) -> [u64; 3] {
        let at_us = EPOCH_US + (self.at_s * 1_000_000) as i64;
        let after = self.ran.parts.iter().filter(|it| it.time.0 > at_us);
        after.fold([0; 3], |[all, judged, failed], part| {
            let beyond =
                part.verdict == "fail" && !part.reasons.iter().all(|it| it.ends_with("not proven"));
            [
                all + 1,
                judged + u64::from(part.verdict != "void"),
                failed + u64::from(beyond && self.ran.is_good(part)),
            ]
        })
    }
}

/// Returns the figures of `instants` instants of each fault.
///
/// # Errors
/// Fails when the rig cannot be built.
pub fn figures(instants: u64) -> anyhow::Result<Vec<Figure>> {
    let mut dice = Dice::new(25);
    let mut all = Vec::new();
    for which in 0..FAULTS.len() {
        for seed in 1..=instants {
            let [from, to] = INSTANTS_S;
            all.push((which, seed, dice.between(from, to)));
        }
    }
    let struck = pool::map(&all, LOTS_AT_ONCE, |(which, seed, at_s)| {
        let ran = run(&lot(FAULTS[*which].0, *seed, *at_s))?;
        Ok(Struck {
            which: *which,
            seed: *seed,
            at_s: *at_s,
            ran,
        })
    })?;
    let of = |(which, (name, must)): (usize, &(&str, Must))| {
        let own: Vec<&Struck> = struck.iter().filter(|it| it.which == which).collect();
        of_fault(name, *must, &own)
    };
    let mut figures: Vec<Figure> = FAULTS.iter().enumerate().flat_map(of).collect();
    let writes = struck.iter().map(|it| it.ran.eeprom_writes).sum();
    figures.push(Figure::none("EEPROM writes", struck.len() as u64, writes));
    Ok(figures)
}

fn lot(fault: &str, seed: u64, at_s: u64) -> Lot {
    Lot {
        recipe: RECIPE,
        parts: PARTS,
        seed,
        faults: vec![match fault.contains('=') {
            true => format!("{fault}@{at_s}"),
            false => format!("{fault}={at_s}"),
        }],
        changes: Vec::new(),
    }
}

/// Returns the figures of one fault: how long the heater stays on, and how many parts have a wrong verdict.
fn of_fault(name: &str, must: Must, all: &[&Struck]) -> [Figure; 2] {
    let counts = all.iter().map(|it| it.judged());
    let [parts, judged, failed] =
        counts.fold([0; 3], |sum, it| std::array::from_fn(|at| sum[at] + it[at]));
    let failed = Figure::none(format!("{name}, good parts failed"), parts, failed)
        .with("judged", Some(judged as f64));
    match must {
        Must::Stop(within_s) | Must::StopOncePowered(within_s) => [
            heated(name, must, all).bar(Bar::AtMost(within_s)),
            Figure::none(format!("{name}, parts judged"), parts, judged),
        ],
        Must::StopOrStayRight => [heated(name, must, all), failed],
    }
}

/// Returns the longest time for which the heater stays on after a fault. Further columns have the number of lots
/// that an alarm ended, and seed and instant of the lot with the longest time.
fn heated(name: &str, must: Must, all: &[&Struck]) -> Figure {
    let heats = all.iter().filter_map(|it| Some((it.heats_s(must)?, *it)));
    let heats: Vec<(f64, &Struck)> = heats.collect();
    let longest = heats.iter().max_by(|a, b| a.0.total_cmp(&b.0));
    let heated_s = longest.map_or(0.0, |it| it.0);
    let n = heats.len() as u64;
    let seen = all.iter().filter(|it| it.is_seen()).count();
    Figure::new(format!("{name}, heater on"), n, Some(heated_s), "s")
        .with("alarms", Some(seen as f64))
        .with("seed", longest.map(|it| it.1.seed as f64))
        .with("at_s", longest.map(|it| it.1.at_s as f64))
}
