//! Reproducible figures of the rig, each beside its bar: the limit that the figure must meet.
//!
//! A study runs lots on the simulated rig in virtual time, each in a process of this very program, compares the rows of
//! the parts with the truth about the parts (`--truth`), and prints the figures.
//!
//! - Lot `n` of a study runs with seed `n`, so that one `relayrig run` repeats the lot behind a figure.
//! - A world is a file that sets the properties of the simulated rig: parts, defects, errors of instruments.
//! - A good part is one without a defect; only good parts count for errors and coverage. A good part whose true value
//!   lies beyond a limit is rightly rejected: the figures about bins count it neither as good nor as defective; a row
//!   of its own counts such parts.
//! - A figure without a value (nothing measured, nothing reported) misses its bar.
//! - No figure mixes rig time (time of the simulated rig) and wall time: wall time appears only in `collision`,
//!   `fleet`, `history`, `pace`, `plan`, `storm` and `transient`.
//!
//! `chamber`, `collision`, `plan`, `ssr`, `thermostat` and `transient` run no lot of the rig. `chamber` and
//! `thermostat` run the arithmetic of the controller on the simulated chamber, `ssr` on a model of its signals.
//! `collision` compares ways to check a move with the exact truth, `plan` compares orders of tooling with brute force,
//! `transient` integrates the relay model of the simulated rig.
//!
//! [`figures`] runs a plan of studies and benchmarks and writes their figures as one document.
//!
//! ```
//! // Without --lots and --parts, the study of accuracy runs 10 lots of 500 parts.
//! assert_eq!(studies::Study::Accuracy.usual(), Some((10, 500)));
//! ```

mod bins;
mod chart;
mod coil;
mod collision;
mod contact;
mod controllers;
mod curves;
mod cycle;
mod decision;
mod dice;
mod error;
mod exception;
mod figure;
pub mod figures;
mod fleet_trial;
mod gantt;
mod gauge;
mod history;
mod journal;
mod kill;
mod life;
mod lot;
mod method;
mod order;
mod output;
mod pace;
mod parameters;
mod path;
mod plan;
mod pool;
mod promises;
mod risk;
mod scatter;
mod ssr;
mod stop;
mod storm;
#[cfg(test)]
mod tests;
mod thermostat;
mod threshold;
mod timing;
mod transient;
mod variant;
mod verification;

use anyhow::bail;
use clap::ValueEnum;
pub use collision::study as collision;
pub use controllers::study as controllers;
pub use figure::Bar;
pub use gantt::svg as cycle_gantt;
pub use order::Order;
pub use output::Report;
pub use plan::{SCENES as PLAN_SCENES, study as plan};
pub use ssr::{PARTS as SSR_PARTS, study as ssr};
pub use thermostat::study as thermostat;
pub use thermostat::{Scope as ThermostatScope, Section as ThermostatSection};
pub use transient::{USUAL_RTOL, study as transient};

/// The studies, in the order of the list that `relayrig study` prints.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Study {
    /// Error of every parameter against the truth, and bins of the parts
    Accuracy,
    /// Controllers of a test chamber: tracking, overshoot, settling, open door, weak and strong heater
    Chamber,
    /// Measuring time against error of the coil resistance: settling, scans, self-heating, temperature
    Coil,
    /// Ways to check a move: time against error and wrong verdicts
    Collision,
    /// Measuring time against error of contacts: polarities, drifting EMF, closures, early stop
    Contact,
    /// How often the stated uncertainty covers the truth
    Coverage,
    /// Rig time of a test and of a cycle, and its pieces
    Cycle,
    /// Sending to a PostgreSQL server of its own, and questions to many made-up rigs in it
    Fleet,
    /// Share of the gauge in the scatter of each characteristic (%GRR)
    Gauge,
    /// Speed of the history on a made-up file
    History,
    /// False accepts and rejects, counted and as the decision rule predicts them
    Decision,
    /// Seconds against error of the methods for solid-state relays
    Ssr,
    /// The emergency stop at every instant of a cycle and of homing, and how long outputs stay on
    Stop,
    /// Switching temperatures of parts in a chamber: error, coverage, minutes and parts per hour
    Thermostat,
    /// Seconds against error of every strategy for the thresholds
    Threshold,
    /// Lots killed at random instants: rows lost, rows twice, damage
    Kill,
    /// Memory, open files and rows of `serve` over many lots
    Life,
    /// Parts per second of wall time, and whether the same seed gives the same bytes
    Pace,
    /// Plans for tooling: false blocks of boxes, orders against brute force, growth
    Plan,
    /// Good parts rejected, defects by bin, over many lots
    Sorting,
    /// Whether a rig that breaks a promise of its files is noticed, or its results still covered; false alarms
    Promises,
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
    /// Returns the default number of lots and of parts of a lot; `None` for a study without lots.
    pub const fn usual(self) -> Option<(u64, u64)> {
        Some(match self {
            Self::Accuracy => (10, 500),
            Self::Coil | Self::Contact | Self::Threshold | Self::Timing => (4, 40),
            Self::Chamber | Self::Collision | Self::Plan | Self::Ssr | Self::Transient => {
                return None;
            }
            Self::Coverage => (100, 10),
            Self::Cycle => (1, 100),
            Self::Decision => (20, 500),
            Self::Fleet => (20, 20_000),
            Self::Gauge => (1, 10),
            Self::History => (1, 1_000_000),
            Self::Kill => (300, 1),
            Self::Life => (200, 500),
            Self::Pace => (3, 300),
            Self::Promises => (2, 60),
            Self::Sorting => (100, 110),
            Self::Storm => (200, 4),
            Self::Stop => (16, 25),
            Self::Thermostat => (20, 40),
            Self::Verification => (20, 10),
        })
    }

    /// Runs the study and makes its report.
    ///
    /// # Errors
    /// Fails for a study without lots, when a file cannot be read or written, or when a lot cannot be run.
    pub fn report(self, order: &Order) -> anyhow::Result<Report> {
        match self {
            Self::Accuracy => parameters::accuracy(order),
            Self::Coil => coil::study(order),
            Self::Contact => contact::study(order),
            Self::Coverage => parameters::coverage(order),
            Self::Cycle => cycle::study(order),
            Self::Decision => decision::study(order),
            Self::Fleet => fleet_trial::study(order),
            Self::Gauge => gauge::study(order),
            Self::History => history::study(order),
            Self::Kill => kill::study(order),
            Self::Life => life::study(order),
            Self::Pace => pace::study(order),
            Self::Promises => promises::study(order),
            Self::Sorting => bins::study(order),
            Self::Stop => stop::study(order),
            Self::Storm => storm::study(order),
            Self::Threshold => threshold::study(order),
            Self::Timing => timing::study(order),
            Self::Verification => verification::study(order),
            Self::Chamber
            | Self::Collision
            | Self::Plan
            | Self::Ssr
            | Self::Thermostat
            | Self::Transient => {
                bail!(
                    "the studies chamber, collision, plan, ssr, thermostat and transient run no lot"
                )
            }
        }
    }
}
