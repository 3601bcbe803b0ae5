//! Reaction time of motion outputs to the emergency stop, pressed at every instant of a cycle and of homing.
//!
//! Every lot is a script (`relayrig story`) that presses the stop again and again, each time a little later: after a
//! part leaves the nest, or after the reset of a line that was stopped in the middle of a test. Each time the script
//! then releases the stop, clears, resets and starts the line. The journal of the simulated rig gives the instants at
//! which the emergency-stop contact opens and the last motion output goes off. The bound of the reaction time follows
//! from `rig.toml` and holds for any delay or loss of one transaction; every second lot therefore runs with replies at
//! the end of their timeout.

mod reaction;
mod sweep;

use super::chart::Chart;
use super::figure::{Bar, Figure};
use super::journal;
use super::order::Order;
use super::output::Report;
use app::progress::{PIECES, progress};
use config::Plant;
use machine::rig::point::DigitalOut;
use machine::rig::wiring::Wiring;
use quality::Ordered;
use reaction::reactions;
use std::collections::BTreeMap;
use std::path::Path;
use sweep::Sweep;
use tempfile::TempDir;

/// Delay of the replies in every second lot, ms: 3 ms less than the timeout in `rig.toml`.
const LATE_MS: f64 = 25.0;
/// Number of classes of instants; each is a bar of the chart.
const CLASSES: usize = 20;

/// One press of the emergency stop.
#[derive(Debug, Clone, Copy)]
struct Stop {
    /// Time from the start of the swept interval to the press, seconds.
    instant_s: f64,
    /// Time from the opening of the emergency-stop contact until the last motion output is off, milliseconds; `None`
    /// when none was on.
    reaction_ms: Option<f64>,
}

/// Stops of all lots of one sweep, with usual or with late replies.
#[derive(Debug)]
struct SweepResult {
    sweep: Sweep,
    slow: bool,
    stops: Vec<Stop>,
    touched: u64,
    unfinished: u64,
}

impl SweepResult {
    fn empty(sweep: Sweep, slow: bool) -> Self {
        Self {
            sweep,
            slow,
            stops: Vec::new(),
            touched: 0,
            unfinished: 0,
        }
    }

    fn name(&self) -> String {
        let modules = match self.slow {
            true => format!("replies {LATE_MS} ms late"),
            false => "modules as they are".to_owned(),
        };
        format!("reaction {}, {modules}", self.sweep.name())
    }
}

/// Plays the lots and makes the report.
///
/// # Errors
/// Fails when the configuration does not load, or when a story does not run.
pub fn study(order: &Order) -> anyhow::Result<Report> {
    let plant = Plant::load(&order.folder())?;
    let bound_ms = plant.wiring.longest_reaction().as_seconds() * 1e3;
    let folder = TempDir::new()?;
    let of = |sweep| [false, true].map(|slow| SweepResult::empty(sweep, slow));
    let mut all: Vec<SweepResult> = Sweep::ALL.into_iter().flat_map(of).collect();
    let lots = order.lots * Sweep::ALL.len() as u64;
    let bar = progress(Some(lots), PIECES);
    for result in &mut all {
        for lot in (u64::from(result.slow)..order.lots).step_by(2) {
            play_lot(order, folder.path(), &plant.wiring, lot, result)?;
            bar.inc(1);
        }
    }
    bar.finish_and_clear();
    let sum = |of: fn(&SweepResult) -> u64| all.iter().map(of).sum::<u64>();
    let reactions = all.iter().map(|result| reaction(result, bound_ms));
    let bound = Figure::new("bound of rig.toml", 1, Some(bound_ms), "ms");
    let groups = vec![
        reactions.chain([bound]).collect(),
        vec![
            Figure::none("bodies that touched", lots, sum(|it| it.touched)),
            Figure::none("lots that did not complete", lots, sum(|it| it.unfinished)),
        ],
    ];
    let stops = order.lots * order.parts;
    let about = format!("{stops} stops over a cycle and as many over homing after a stop");
    Ok(Report::new("stop", about, groups, chart(&all[0], bound_ms)))
}

fn reaction(result: &SweepResult, bound_ms: f64) -> Figure {
    let stops = result.stops.iter();
    let times: Vec<f64> = stops.filter_map(|stop| stop.reaction_ms).collect();
    let (ordered, n) = (Ordered::of(&times), result.stops.len() as u64);
    Figure::new(result.name(), n, ordered.quantile(1.0), "ms")
        .with("median", ordered.quantile(0.5))
        .with("p99", ordered.quantile(0.99))
        .with("outputs_were_on", Some(times.len() as f64))
        .bar(Bar::AtMost(bound_ms))
}

/// Draws the longest reaction in each class of instants in the cycle.
fn chart(result: &SweepResult, bound_ms: f64) -> Chart {
    let width = result.sweep.span_s() / CLASSES as f64;
    let worst = |class: usize| {
        let stops = result.stops.iter();
        let inside = stops.filter(|stop| (stop.instant_s / width) as usize == class);
        inside.filter_map(|stop| stop.reaction_ms).reduce(f64::max)
    };
    let title =
        "worst reaction to the emergency stop by the instant after a part has left the nest";
    let bars = (0..CLASSES).map(|class| (format!("{:.1} s", class as f64 * width), worst(class)));
    Chart::new(title, "ms", vec![bound_ms], bars)
}

fn play_lot(
    order: &Order,
    folder: &Path,
    wiring: &Wiring,
    lot: u64,
    result: &mut SweepResult,
) -> anyhow::Result<()> {
    let sweep = result.sweep;
    let instants = sweep.instants(order, lot);
    let script = sweep.script(&instants, result.slow);
    let played = journal::play(order, folder, &script, lot + 1)?;
    let reactions = reactions(&played.entries, &moving(wiring));
    let last = reactions
        .chunks_exact(sweep.presses())
        .map(|all| all[all.len() - 1]);
    let stops = instants.into_iter().zip(last);
    result
        .stops
        .extend(stops.map(|(instant_s, reaction_ms)| Stop {
            instant_s,
            reaction_ms,
        }));
    result.touched += played.text.matches("BODIES TOUCHED").count() as u64;
    result.unfinished += u64::from(!played.completed);
    Ok(())
}

/// Returns the bit mask of the motion outputs of each module, by the name of the module.
fn moving(wiring: &Wiring) -> BTreeMap<String, u16> {
    let mut bits = BTreeMap::new();
    for point in DigitalOut::OF_FEEDER.iter().filter(|point| point.moves()) {
        let terminal = wiring.digital_out(*point);
        *bits
            .entry(wiring.module(terminal.module).name.clone())
            .or_insert(0) |= terminal.bit();
    }
    bits
}
