//! The report of the storm: counts over all seeds, and the seeds that break a rule.

use super::judge::Case;
use super::life::End;
use super::trace;
use crate::chart::Chart;
use crate::figure::{Bar, Figure};
use crate::order::Order;
use crate::output::Report;
use app::exit::Exit;

/// Largest number of seeds that the report shows; the figures count all of them.
const SHOWN: usize = 10;

/// Result of one seed: counts, and the trace only when the seed breaks a rule, because a trace is large.
pub struct Outcome {
    pub(super) seed: u64,
    pub(super) counts: Counts,
    pub(super) violations: Vec<String>,
    pub(super) hold_us: u64,
    pub(super) faults: Vec<String>,
    pub(super) trace: Vec<String>,
    pub(super) digest: u64,
}

/// Numbers of lives, kills, bodies, rows, alarms, orders and motions of a case, and its rig time.
#[derive(Debug, Clone, Copy, Default)]
pub struct Counts {
    lives: u64,
    kills: u64,
    completed: u64,
    bodies: u64,
    rows: u64,
    alarms: u64,
    orders: u64,
    motions: u64,
    rig_us: u64,
}

impl Counts {
    /// Counts the contents of a case.
    pub fn of(case: &Case) -> Self {
        let ended = |end: &End| case.lives.iter().filter(|it| it.end == *end).count() as u64;
        Self {
            lives: case.lives.len() as u64,
            kills: ended(&End::Killed),
            completed: ended(&End::Exit(Exit::Done)),
            bodies: case.bodies.len() as u64,
            rows: case.rows.len() as u64,
            alarms: case.alarms.len() as u64,
            orders: case.lives.iter().map(|it| it.answers.len() as u64).sum(),
            motions: case.driven.len() as u64,
            rig_us: case.lives.last().map_or(0, |life| life.ended_us),
        }
    }
}

/// Makes the report of the seeds; they took `minutes` of wall time.
pub fn report(order: &Order, outcomes: &[Outcome], minutes: f64) -> Report {
    let n = outcomes.len() as u64;
    let violations = outcomes
        .iter()
        .filter(|it| !it.violations.is_empty())
        .count() as u64;
    let sum = |of: fn(&Counts) -> u64| outcomes.iter().map(|it| of(&it.counts)).sum::<u64>();
    let hours = sum(|it| it.rig_us) as f64 / 3.6e9;
    let lives = sum(|it| it.lives);
    let about = |name: &str, of: u64, count: u64| Figure::count(name, of, Some(count));
    let rule = Figure::count("seeds that broke a rule", n, Some(violations));
    let counts = vec![
        about("kills of the controller", lives, sum(|it| it.kills)),
        about("lots completed", lives, sum(|it| it.completed)),
        about("bodies", n, sum(|it| it.bodies)),
        about("rows", n, sum(|it| it.rows)),
        about("alarms", n, sum(|it| it.alarms)),
        about("orders", n, sum(|it| it.orders)),
        about("motions", n, sum(|it| it.motions)),
    ];
    let per_minute = Some(hours / minutes);
    let pace = Figure::new("virtual hours per minute of wall time", n, per_minute, "h");
    let digests = outcomes.iter().map(|it| format!("{:016x}", it.digest));
    let digest = trace::digest(digests);
    let mut notes = vec![format!("digest of all traces: {digest:016x}")];
    let shows = |it: &&Outcome| order.seed.is_some() || !it.violations.is_empty();
    let worth = outcomes.iter().filter(shows).take(SHOWN);
    notes.extend(worth.map(|it| shown(order, it)));
    let alarms = |it: &Outcome| (format!("seed {}", it.seed), Some(it.counts.alarms as f64));
    let title = format!("alarms by seed: {}", order.about());
    let chart = Chart::new(title, "", Vec::new(), outcomes.iter().take(40).map(alarms));
    let groups = vec![vec![rule.bar(Bar::AtMost(0.0))], counts, vec![pace]];
    Report::new("storm", order.about(), groups, chart).noted(notes)
}

fn shown(order: &Order, it: &Outcome) -> String {
    let seed = it.seed;
    // A report of one seed shows the whole trace.
    let last = match order.seed {
        Some(_) => it.trace.join("\n  "),
        None => trace::last(&it.trace).join("\n  "),
    };
    let what = match it.violations.as_slice() {
        [] => "no rule broken".to_owned(),
        some => some.join("; "),
    };
    format!(
        "seed {seed}: {what}\n  faults, of {} ms at an instant: {}\n  {last}\n  again: relayrig --config {} study storm --recipe {} --seed {seed} --parts {}",
        it.hold_us as f64 / 1e3,
        it.faults.join(" "),
        order.config.display(),
        order.recipe.name,
        order.parts,
    )
}
