//! `relayrig study thermostat`: temperature relays in a chamber, against the truth, in sections.
//!
//! | section | shows | runs |
//! |---|---|---|
//! | `accuracy` | errors, coverage, minutes, parts per hour | passes, control and judgement of the program on chamber and rack |
//! | `independence` | results at other rates and with other controllers | the same |
//! | `worlds` | coverage in other worlds | the same |
//! | `control` | tracking, excess, slope of a referee test | the controller on the chamber |
//! | `program` | coverage, verdicts and wall time of whole batches, with a slow bus too | the program on the simulated rig |
//! | `faults` | time until the heater is off, verdicts | the program on the simulated rig |
//! | `kills` | outputs after a kill, the next start | the program on the simulated rig |
//! | `storm` | rules that hold under random faults and kills | the program on the simulated rig |
//!
//! The first three sections have no line and no module: each seed draws a chamber, its sensors, a lot and its sockets.
//! The first batch of a lot measures the lag in two passes; the next one uses this lag in a single pass. The measuring
//! chain and the map of the sockets are calibrated. A batch begins right after the one before, with the air at 45 C and
//! the parts at room temperature, and ends below 54 C. The time of loading counts for parts per hour only. The program
//! runs in virtual time.

mod elsewhere;
mod faults;
mod heat;
mod kill;
mod lots;
mod program;
mod rack;
mod rig;
mod score;
mod storm;
#[cfg(test)]
mod tests;
mod whole;
mod world;

use super::chart::Chart;
use super::controllers;
use super::curves::Curves;
use super::figure::Figure;
use super::output::Report;
use clap::ValueEnum;
use lots::BARS;
use machine::dut::thermostat::recipe::Control;
use rack::Batch;

/// Number of seeds for other worlds, and for other numbers of sockets.
const FEW: u64 = 10;
/// Kills of the controller of a batch.
const KILLS: u64 = 50;
/// Random instants of each fault.
const INSTANTS: u64 = 6;
/// Least coverage of the stated uncertainty in other worlds, percent.
const LEAST_COVERAGE: f64 = 93.0;

/// A section of the study.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Section {
    /// Errors, coverage, minutes and parts per hour
    Accuracy,
    /// Results at other rates and with other controllers
    Independence,
    /// Coverage in other worlds
    Worlds,
    /// Tracking, excess over the end of a ramp, slope of a referee test
    Control,
    /// Whole batches by the program, with a slow bus too
    Program,
    /// Faults at random instants
    Faults,
    /// Kills of the program while it heats
    Kills,
    /// Rules under random faults and kills, by seed
    Storm,
}

/// What the study is to do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Scope {
    /// Number of lots of each kind in section `accuracy`, and of storms. Every other section changes its number of runs
    /// in the ratio of this number to the usual 20.
    pub seeds: u64,
    /// Number of sockets.
    pub sockets: usize,
    /// Section; `None` for all.
    pub only: Option<Section>,
}

impl Scope {
    fn has(&self, section: Section) -> bool {
        self.only.is_none_or(|only| only == section)
    }

    /// Returns a number of runs, changed in the ratio of the seeds to their usual number; at least 1.
    fn of(&self, usual: u64) -> u64 {
        const SEEDS: u64 = 20;
        (usual * self.seeds).div_ceil(SEEDS).max(1)
    }
}

/// Runs the sections; returns the report, and the first batch of each kind as SVG.
///
/// # Errors
/// Fails when a chamber does not respond, the machine ends a batch early, or the rig cannot be built.
pub fn study(scope: &Scope) -> anyhow::Result<(Report, String)> {
    let (mut groups, mut curves, mut bars) = (Vec::new(), Vec::new(), Vec::new());
    for kind in &BARS {
        if scope.has(Section::Accuracy) {
            let lots = lots::lots(kind.kind, scope.seeds, scope.sockets)?;
            groups.push(lots::accuracy(kind, &lots));
            groups.push(lots::coverage(kind, &lots));
            groups.push(lots::pace(kind, &lots, scope)?);
            bars.extend(lots::chart(kind, &lots));
            let first = lots.first().map(|it| it.two.curve.clone());
            curves.extend(first.map(|it| (kind.kind.name.to_owned(), it)));
        }
        if scope.has(Section::Independence) {
            groups.push(elsewhere::independence(kind.kind, scope)?);
        }
        if scope.has(Section::Worlds) {
            groups.push(elsewhere::worlds(kind.kind, scope)?);
        }
    }
    groups.extend(others(scope)?);
    let mut notes = Vec::new();
    if scope.has(Section::Storm) {
        let (figures, broken) = storm::figures(scope.seeds)?;
        groups.push(figures);
        notes = broken;
    }
    let about = format!(
        "{} lots x {} sockets of each kind, chain and map calibrated",
        scope.seeds, scope.sockets
    );
    let chart = Chart::new(
        "rms error of the operate temperature",
        "K",
        vec![0.25],
        bars,
    );
    let plot = Curves {
        title: "Reference sensor in the first batch of a lot".into(),
        x_title: "time, min".into(),
        y_title: "C".into(),
        series: curves,
    };
    let report = Report::new("thermostat", about, groups, chart).noted(notes);
    Ok((report, plot.svg()))
}

/// Runs the sections that do not run once for each kind of part.
fn others(scope: &Scope) -> anyhow::Result<Vec<Vec<Figure>>> {
    let mut groups = Vec::new();
    if scope.has(Section::Control) {
        groups.push(controllers::default_figures()?);
    }
    if scope.has(Section::Program) {
        groups.extend(whole::figures(scope)?);
    }
    if scope.has(Section::Faults) {
        groups.push(faults::figures(scope.of(INSTANTS))?);
    }
    if scope.has(Section::Kills) {
        groups.push(kill::figures(scope.of(KILLS))?);
    }
    Ok(groups)
}

/// Returns a batch with the usual controller. The rates, K/min, are that of the first pass of a batch that measures the
/// lag, and that of every other pass.
fn batch(number: u64, sockets: usize, rates: [f64; 2]) -> Batch {
    Batch {
        number,
        sockets,
        rates,
        control: Control::Pid,
    }
}
