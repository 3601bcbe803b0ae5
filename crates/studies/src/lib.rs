//! Figures that anyone can reprint.
//!
//! A study runs lots on the simulated rig in virtual time, each in a process of its own with this very
//! program, sets what the rows say against what the specimens really were (`--truth`), and prints every
//! figure beside the bar it has to keep.
//!
//! - Lot `n` of a study runs with seed `n`, so a figure can be traced back to one `relayrig run`.
//! - A good part is one without a defect; only good parts count for errors and coverage. One that was drawn
//!   beyond a limit all the same is rejected with reason: it counts as neither good nor defective in the
//!   figures about bins, and stands in a row of its own.
//! - A figure that could not be had (nothing measured, nothing reported) has missed its bar.
//! - Rig time and wall time are never mixed: wall time appears in `pace` and `collision` only.
//!
//! `collision` runs no lot and needs no rig: it sets ways to check a move against the exact truth.

mod accuracy;
mod bins;
mod chance;
mod chart;
mod coil;
mod collision;
mod contact;
mod coverage;
mod cycle;
mod decision;
mod error;
mod exception;
mod figure;
mod fleet;
mod gantt;
mod history;
mod journal;
mod kill;
mod lot;
mod method;
mod output;
mod pace;
mod parameters;
mod path;
mod scatter;
mod sorting;
mod stop;
mod storm;
#[cfg(test)]
mod tests;
mod threshold;
mod timing;
mod transient;
mod variant;
mod verification;

use anyhow::bail;
use clap::ValueEnum;
use config::load_recipe;
pub use fleet::Order;
use machine::dut::em_relay::Parameter;
pub use output::Report;
use std::path::Path;

/// Tolerance of a step of the relay model unless another one is asked for.
pub const USUAL_RTOL: f64 = transient::USUAL_RTOL;

/// What can be studied.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Study {
    /// Error of every parameter against the truth, and where parts went
    Accuracy,
    /// Seconds against error of the coil resistance: settling, scans, self-heating, temperature
    Coil,
    /// Ways to check a move: time against error and wrong verdicts
    Collision,
    /// Seconds against error of contacts: polarities, drifting EMF, closures, early stop
    Contact,
    /// How often the stated uncertainty covers the truth
    Coverage,
    /// Rig time of a test and of a cycle, and where it goes
    Cycle,
    /// Speed of the history on a made-up file
    History,
    /// False accepts and rejects, counted and as the decision rule predicts them
    Decision,
    /// The emergency stop at every instant of a cycle and of homing, and how long outputs stay on
    Stop,
    /// Seconds against error of every strategy for the thresholds
    Threshold,
    /// Lots killed at random instants: rows lost, rows twice, damage
    Kill,
    /// Parts per second of wall time, and whether the same seed gives the same bytes
    Pace,
    /// Good parts rejected, defects by bin, over many lots
    Sorting,
    /// Short lots under random faults, orders and kills: bodies, rows, motions and endings
    Storm,
    /// Error of times and bounce: latched and raw gates, reference clock, gate delay
    Timing,
    /// The relay model of the simulated rig over the cases of a file
    Transient,
    /// How often a verification fails a rig that has not changed
    Verification,
}

impl Study {
    /// Lots and parts of a lot when nothing else is asked for; none where no lot is run.
    pub const fn usual(self) -> Option<(u64, u64)> {
        match self {
            Self::Accuracy => Some((10, 500)),
            Self::Coil | Self::Contact | Self::Timing => Some((4, 40)),
            Self::Collision => None,
            Self::Coverage => Some((100, 10)),
            Self::Cycle => Some((1, 100)),
            Self::Decision => Some((20, 500)),
            Self::History => Some((1, 1_000_000)),
            Self::Kill => Some((300, 1)),
            Self::Pace => Some((3, 300)),
            Self::Sorting => Some((100, 110)),
            Self::Storm => Some((200, 4)),
            Self::Threshold => Some((4, 40)),
            Self::Stop => Some((16, 25)),
            Self::Transient => None,
            Self::Verification => Some((20, 10)),
        }
    }

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Accuracy => "accuracy",
            Self::Coil => "coil",
            Self::Collision => "collision",
            Self::Contact => "contact",
            Self::Coverage => "coverage",
            Self::Cycle => "cycle",
            Self::History => "history",
            Self::Decision => "decision",
            Self::Threshold => "threshold",
            Self::Kill => "kill",
            Self::Pace => "pace",
            Self::Sorting => "sorting",
            Self::Storm => "storm",
            Self::Timing => "timing",
            Self::Stop => "stop",
            Self::Transient => "transient",
            Self::Verification => "verification",
        }
    }

    /// Runs the study and draws its report up.
    ///
    /// # Errors
    /// A study without lots, files that cannot be read or written, a lot that did not start.
    pub fn report(self, order: &Order) -> anyhow::Result<Report> {
        match self {
            Self::Accuracy => accuracy::study(order),
            Self::Coil => coil::study(order),
            Self::Collision => bail!("study collision runs no lot"),
            Self::Contact => contact::study(order),
            Self::Coverage => coverage::study(order),
            Self::Cycle => cycle::study(order),
            Self::History => history::study(order),
            Self::Decision => decision::study(order),
            Self::Threshold => threshold::study(order),
            Self::Kill => kill::study(order),
            Self::Pace => pace::study(order),
            Self::Sorting => sorting::study(order),
            Self::Storm => storm::study(order),
            Self::Timing => timing::study(order),
            Self::Stop => stop::study(order),
            Self::Transient => bail!("study transient runs no lot"),
            Self::Verification => verification::study(order),
        }
    }
}

/// Sets ways to check a move against the exact truth; the report, and the plot as SVG.
///
/// # Errors
/// A world that cannot be made.
pub fn collision() -> anyhow::Result<(Report, String)> {
    let (report, plot) = collision::study()?;
    Ok((report, plot.svg()))
}

/// One part through all stations, as SVG.
///
/// # Errors
/// A lot that could not be run.
pub fn cycle_gantt(order: &Order) -> anyhow::Result<String> {
    gantt::svg(order)
}

/// Runs the relay model of the simulated rig over the cases of a file (`-`: standard input), a line per case.
///
/// # Errors
/// Cases that cannot be read.
pub fn transient(cases: &Path, rtol: f64, json: bool) -> anyhow::Result<String> {
    transient::study(cases, rtol, json)
}

/// Nominal coil voltage of the recipe, V; NaN for a kind without one.
///
/// # Errors
/// A recipe that is refused.
pub fn nominal_v(config: &Path, recipe: &str) -> anyhow::Result<f64> {
    let part = load_recipe(config, recipe)?.device.part();
    Ok(part.nominal_v.unwrap_or(f64::NAN))
}

/// What the recipe admits; a limit that it does not set is infinite.
///
/// # Errors
/// A recipe that is refused.
pub fn admitted(config: &Path, recipe: &str) -> anyhow::Result<lot::Admitted> {
    let limits = load_recipe(config, recipe)?.limits;
    let range = |parameter: &Parameter| {
        let limit = limits.of(*parameter);
        let (low, high) = (limit.low, limit.high);
        (
            *parameter,
            low.unwrap_or(f64::NEG_INFINITY)..=high.unwrap_or(f64::INFINITY),
        )
    };
    Ok(Parameter::ALL.iter().map(range).collect())
}
