//! `relayrig study`: figures that anyone can reprint.
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
//!
//! Exit status: 0 every bar is kept, 1 a bar is missed, 2 bad input or a lot that did not start.

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
#[cfg(feature = "sim")]
mod storm;
#[cfg(test)]
mod tests;
mod threshold;
mod timing;
#[cfg(feature = "sim")]
mod transient;
mod variant;
mod verification;

use anyhow::{Context, bail};
use clap::ValueEnum;
use config::load_recipe;
use fleet::Order;
use machine::dut::em_relay::Parameter;
use output::Report;
use serde_json::json;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Every bar is kept.
const ALL_MET: i32 = 0;
/// A bar is missed.
const BAR_MISSED: i32 = 1;

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
    const fn usual(self) -> Option<(u64, u64)> {
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

    fn name(self) -> &'static str {
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

    fn report(self, order: &Order) -> anyhow::Result<Report> {
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
            Self::Storm => storms(order),
            Self::Timing => timing::study(order),
            Self::Stop => stop::study(order),
            Self::Transient => bail!("study transient runs no lot"),
            Self::Verification => verification::study(order),
        }
    }
}

/// A study, or the list of them.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Examples:
  relayrig study
  relayrig study accuracy
  relayrig study coverage --json
  relayrig study cycle --out figures
  relayrig study collision --out figures
  relayrig study accuracy --seeds 2 --parts 50 --recipe jzc-22f-009
  relayrig study storm --seeds 10000
  relayrig study storm --seeds 1000 --from 10001
  relayrig study storm --seed 17
  relayrig study transient --cases src/cli/study/transient/cases.json --rtol 1e-10 --json

Exit status: 0 every bar is kept, 1 a bar is missed, 2 bad input.")]
pub struct StudyArgs {
    /// What to study; without it the studies are listed
    #[arg(value_enum, value_name = "NAME")]
    pub name: Option<Study>,
    /// One JSON object per figure, then a summary
    #[arg(long)]
    pub json: bool,
    /// Also writes NAME.csv and NAME.svg into this directory; `cycle` adds cycle-gantt.svg, one part through all stations
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Lots, with seeds 1 to N; `pace` runs seed 1 N times
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=100_000))]
    pub seeds: Option<u64>,
    /// First seed of `storm` [default: 1]
    #[arg(long, value_name = "S", conflicts_with = "seed")]
    pub from: Option<u64>,
    /// Only this seed of `storm`
    #[arg(long, value_name = "S", conflicts_with = "seeds")]
    pub seed: Option<u64>,
    /// Parts of each lot
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    pub parts: Option<u64>,
    /// Recipe in config/recipes
    #[arg(long, value_name = "NAME", default_value = "jzc-22f-012")]
    pub recipe: String,
    /// World of the simulated rig instead of config/sim.toml
    #[arg(long, value_name = "FILE")]
    pub world: Option<PathBuf>,
    /// Cases of `transient`, `-` for standard input
    #[arg(long, value_name = "FILE")]
    pub cases: Option<PathBuf>,
    /// Tolerance of a step of `transient`, 1e-14 to 1e-2 [default: 1e-8]
    #[arg(long, value_name = "X", value_parser = tolerance)]
    pub rtol: Option<f64>,
}

/// Runs the command; the result is the exit status.
///
/// # Errors
/// Bad input, a lot that ended with bad input, or an output that cannot be written.
pub fn run(config: &Path, args: &StudyArgs) -> anyhow::Result<i32> {
    let Some(study) = args.name else {
        print(&listed(args.json))?;
        return Ok(ALL_MET);
    };
    if study == Study::Collision {
        return collisions(args);
    }
    if !cfg!(feature = "sim") {
        bail!("study: this is a plant build without the simulated rig");
    }
    match (study == Study::Transient, &args.cases, args.rtol) {
        (true, _, _) => return transients(args),
        (false, None, None) => {}
        (false, _, _) => bail!("--cases and --rtol belong to `study transient`"),
    }
    if (args.seed.is_some() || args.from.is_some()) && study != Study::Storm {
        bail!("--seed and --from belong to `study storm`");
    }
    if let Some(folder) = &args.out {
        made(folder)?;
    }
    let (lots, parts) = study.usual().unwrap_or((1, 1));
    let order = Order {
        program: std::env::current_exe().context("finding this program")?,
        config: config.to_owned(),
        recipe: args.recipe.clone(),
        admitted: admitted(config, &args.recipe)?,
        world: args.world.clone(),
        faults: Vec::new(),
        lots: args.seeds.unwrap_or(lots),
        from: args.from.unwrap_or(1),
        seed: args.seed,
        parts: args.parts.unwrap_or(parts),
    };
    let report = study.report(&order)?;
    if let (Study::Cycle, Some(folder)) = (study, &args.out) {
        written(&folder.join("cycle-gantt.svg"), &gantt::svg(&order)?)?;
    }
    published(&report, args)
}

fn collisions(args: &StudyArgs) -> anyhow::Result<i32> {
    if args.seeds.is_some() || args.parts.is_some() || args.world.is_some() {
        bail!("study collision: --seeds, --parts and --world belong to studies that run lots");
    }
    let (report, plot) = collision::study()?;
    if let Some(folder) = &args.out {
        made(folder)?;
        written(&folder.join("collision-speed.svg"), &plot.svg())?;
    }
    published(&report, args)
}

/// Writes the files that were asked for, prints, and turns the bars into the exit status.
fn published(report: &Report, args: &StudyArgs) -> anyhow::Result<i32> {
    if let Some(folder) = &args.out {
        made(folder)?;
        let file = |ending: &str| folder.join(format!("{}.{ending}", report.study));
        written(&file("csv"), &report.csv())?;
        written(&file("svg"), &report.chart.svg())?;
    }
    print(&if args.json {
        report.json()
    } else {
        report.text()
    })?;
    Ok(if report.all_met() {
        ALL_MET
    } else {
        BAR_MISSED
    })
}

fn made(folder: &Path) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder).with_context(|| format!("--out {}", folder.display()))
}

#[cfg(feature = "sim")]
fn transients(args: &StudyArgs) -> anyhow::Result<i32> {
    if args.out.is_some() || args.seeds.is_some() || args.parts.is_some() || args.world.is_some() {
        bail!(
            "study transient: --out, --seeds, --parts and --world belong to studies that run lots; it prints one answer per case"
        );
    }
    let Some(cases) = &args.cases else {
        bail!("study transient: --cases is missing, expected a file of cases or `-`");
    };
    let rtol = args.rtol.unwrap_or(transient::USUAL_RTOL);
    print(&transient::study(cases, rtol, args.json)?)?;
    Ok(ALL_MET)
}

#[cfg(feature = "sim")]
fn storms(order: &Order) -> anyhow::Result<Report> {
    storm::study(order)
}

#[cfg(not(feature = "sim"))]
fn storms(_: &Order) -> anyhow::Result<Report> {
    bail!("study: this is a plant build without the simulated rig");
}

#[cfg(not(feature = "sim"))]
fn transients(_: &StudyArgs) -> anyhow::Result<i32> {
    bail!("study: this is a plant build without the simulated rig");
}

/// No tolerance that the method and the arithmetic can keep.
#[derive(Debug, thiserror::Error)]
#[error("expected a number from 1e-14 to 1e-2")]
struct NoTolerance;

/// `--rtol`.
fn tolerance(text: &str) -> Result<f64, NoTolerance> {
    match text.parse::<f64>() {
        Ok(value) if (1e-14..=1e-2).contains(&value) => Ok(value),
        Ok(_) | Err(_) => Err(NoTolerance),
    }
}

/// What the recipe admits; a limit that it does not set is infinite.
fn admitted(config: &Path, recipe: &str) -> anyhow::Result<lot::Admitted> {
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

fn listed(as_json: bool) -> String {
    let one = |study: &Study| {
        let usual = study.usual();
        let about = study
            .to_possible_value()
            .and_then(|value| value.get_help().map(ToString::to_string))
            .unwrap_or_default();
        if as_json {
            let (lots, parts) = usual.unzip();
            let it = json!({"study": study.name(), "about": about, "lots": lots, "parts": parts});
            format!("{it}\n")
        } else {
            let size = usual.map_or_else(String::new, |(lots, parts)| {
                format!(" ({lots} x {parts} parts)")
            });
            format!("{:<10} {about}{size}\n", study.name())
        }
    };
    Study::value_variants().iter().map(one).collect()
}

fn written(path: &Path, text: &str) -> anyhow::Result<()> {
    std::fs::write(path, text).with_context(|| format!("writing {}", path.display()))
}

/// A reader that has seen enough and closed the pipe is no error.
fn print(text: &str) -> anyhow::Result<()> {
    match std::io::stdout().lock().write_all(text.as_bytes()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(error).context("writing the figures")
        }
        _ => Ok(()),
    }
}
