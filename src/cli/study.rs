//! `relayrig study`: reproducible figures, each with the limit (bar) that it must meet; see [`studies`].
//!
//! Exit status: 0 every bar is kept, 1 a bar is missed, 2 bad input or a lot that did not start.

mod figures;

use anyhow::{Context, bail};
use app::exit::Exit;
use clap::ValueEnum;
use config::load_recipe;
use serde_json::json;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use studies::{Order, Report, Study};

/// A document about all studies and benchmarks.
#[derive(Debug, Clone, clap::Subcommand)]
pub enum Document {
    /// Run the plan of all figures and write docs/figures.md with its pictures
    Figures(figures::FiguresArgs),
}

/// A study, or the list of them.
#[derive(Debug, Clone, clap::Args)]
#[command(
    args_conflicts_with_subcommands = true,
    after_help = "Examples:
  relayrig study
  relayrig study accuracy
  relayrig study coverage --json
  relayrig study cycle --out figures
  relayrig study collision --out figures
  relayrig study chamber --out figures
  relayrig study accuracy --seeds 2 --parts 50 --recipe jzc-22f-009
  relayrig study plan --seeds 2000
  relayrig study ssr --out figures
  relayrig study promises --seeds 20 --lots 600
  relayrig study promises --term operation_scatter_mv --lots 0
  relayrig study storm --seeds 10000
  relayrig study storm --seeds 1000 --from 10001
  relayrig study storm --seed 17
  relayrig study figures --only cycle
  relayrig study thermostat --only faults --seeds 2
  relayrig study transient --cases crates/studies/src/transient/cases.json --rtol 1e-10 --json

Exit status: 0 every bar is kept, 1 a bar is missed, 2 bad input."
)]
pub struct StudyArgs {
    /// Document to make
    #[command(subcommand)]
    pub document: Option<Document>,
    /// Study to run; without it the command lists the studies
    #[arg(value_enum, value_name = "NAME")]
    pub name: Option<Study>,
    /// One JSON object per figure, then a summary
    #[arg(long)]
    pub json: bool,
    /// Also write NAME.csv and NAME.svg into this directory; `cycle` adds cycle-gantt.svg, which shows one part on its
    /// way through all stations
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Number of lots, with seeds 1 to N; `pace` runs seed 1 N times; for `plan`, number of random scenes; for `ssr`,
    /// number of made-up parts
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=100_000))]
    pub seeds: Option<u64>,
    /// First seed of `storm` [default: 1]
    #[arg(long, value_name = "S", conflicts_with = "seed")]
    pub from: Option<u64>,
    /// Only this seed of `storm`
    #[arg(long, value_name = "S", conflicts_with = "seeds")]
    pub seed: Option<u64>,
    /// Number of lots that `promises` runs in worlds that keep every promise
    #[arg(long, value_name = "N", default_value_t = 20)]
    pub lots: u64,
    /// Only this broken promise of `promises`
    #[arg(long, value_name = "KEY")]
    pub term: Option<String>,
    /// Only this section of `thermostat`
    #[arg(long, value_enum, value_name = "SECTION")]
    pub only: Option<studies::ThermostatSection>,
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

/// Runs `relayrig study`.
///
/// # Errors
/// Fails on bad input, when a lot ends with bad input, or when an output cannot be written.
pub fn run(config: &Path, args: &StudyArgs) -> anyhow::Result<Exit> {
    if let Some(Document::Figures(args)) = &args.document {
        return figures::run(config, args);
    }
    let Some(wanted) = args.name else {
        print(&listed(args.json))?;
        return Ok(Exit::Done);
    };
    if args.only.is_some() && wanted != Study::Thermostat {
        bail!("--only belongs to `study thermostat`");
    }
    if wanted == Study::Collision {
        return drawn(args, studies::collision, "collision-speed.svg");
    }
    if wanted == Study::Chamber {
        return drawn(args, studies::controllers, "chamber-errors.svg");
    }
    if wanted == Study::Thermostat {
        return thermostats(args);
    }
    if wanted == Study::Plan {
        return plans(config, args);
    }
    if wanted == Study::Ssr {
        return solid_state(args);
    }
    match (wanted == Study::Transient, &args.cases, args.rtol) {
        (true, _, _) => return transients(args),
        (false, None, None) => {}
        (false, _, _) => bail!("--cases and --rtol belong to `study transient`"),
    }
    if (args.seed.is_some() || args.from.is_some()) && wanted != Study::Storm {
        bail!("--seed and --from belong to `study storm`");
    }
    if let Some(folder) = &args.out {
        made(folder)?;
    }
    let (lots, parts) = wanted.usual().unwrap_or((1, 1));
    let order = Order {
        program: std::env::current_exe().context("finding this program")?,
        config: config.to_owned(),
        recipe: Arc::new(load_recipe(&config.into(), &args.recipe)?),
        world: args.world.clone(),
        faults: Vec::new(),
        lots: args.seeds.unwrap_or(lots),
        from: args.from.unwrap_or(1),
        seed: args.seed,
        parts: args.parts.unwrap_or(parts),
        kept: args.lots,
        term: args.term.clone(),
    };
    let report = wanted.report(&order)?;
    if let (Study::Cycle, Some(folder)) = (wanted, &args.out) {
        written(
            &folder.join("cycle-gantt.svg"),
            &studies::cycle_gantt(&order)?,
        )?;
    }
    published(&report, args)
}

/// Runs a study without lots, and publishes it as [`plotted`] does.
fn drawn(
    args: &StudyArgs,
    study: fn() -> anyhow::Result<(Report, String)>,
    plot_name: &str,
) -> anyhow::Result<Exit> {
    if args.seeds.is_some() || args.parts.is_some() || args.world.is_some() {
        let name = args.name.and_then(|it| it.to_possible_value());
        let name = name.map(|it| it.get_name().to_owned()).unwrap_or_default();
        bail!("study {name}: --seeds, --parts and --world belong to studies that run lots");
    }
    plotted(&study()?, args, plot_name)
}

fn thermostats(args: &StudyArgs) -> anyhow::Result<Exit> {
    if args.world.is_some() {
        bail!(
            "study thermostat: --world belongs to studies that run lots; it has worlds of its own"
        );
    }
    let (seeds, sockets) = Study::Thermostat.usual().unwrap_or((1, 1));
    let sockets = usize::try_from(args.parts.unwrap_or(sockets))?;
    let made = studies::thermostat(&studies::ThermostatScope {
        seeds: args.seeds.unwrap_or(seeds),
        sockets,
        only: args.only,
    })?;
    plotted(&made, args, "thermostat-batch.svg")
}

/// Publishes a report; with `--out`, also writes its second plot, under `name`.
fn plotted(
    (report, plot): &(Report, String),
    args: &StudyArgs,
    name: &str,
) -> anyhow::Result<Exit> {
    if let Some(folder) = &args.out {
        made(folder)?;
        written(&folder.join(name), plot)?;
    }
    published(report, args)
}

fn solid_state(args: &StudyArgs) -> anyhow::Result<Exit> {
    if args.parts.is_some() || args.world.is_some() {
        bail!("study ssr: --parts and --world belong to studies that run lots");
    }
    let parts = args.seeds.unwrap_or(studies::SSR_PARTS);
    published(&studies::ssr(parts)?, args)
}

fn plans(config: &Path, args: &StudyArgs) -> anyhow::Result<Exit> {
    if args.parts.is_some() || args.world.is_some() {
        bail!("study plan: --parts and --world belong to studies that run lots");
    }
    let scenes = args.seeds.unwrap_or(studies::PLAN_SCENES);
    published(&studies::plan(&config.into(), scenes)?, args)
}

/// Writes the files of `--out`, prints the report and returns the exit status of its bars.
fn published(report: &Report, args: &StudyArgs) -> anyhow::Result<Exit> {
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
        Exit::Done
    } else {
        Exit::AnswerIsNo
    })
}

fn made(folder: &Path) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder).with_context(|| format!("--out {}", folder.display()))
}

fn transients(args: &StudyArgs) -> anyhow::Result<Exit> {
    if args.out.is_some() || args.seeds.is_some() || args.parts.is_some() || args.world.is_some() {
        bail!(
            "study transient: --out, --seeds, --parts and --world belong to studies that run lots; it prints one answer per case"
        );
    }
    let Some(cases) = &args.cases else {
        bail!("study transient: --cases is missing, expected a file of cases or `-`");
    };
    let rtol = args.rtol.unwrap_or(studies::USUAL_RTOL);
    print(&studies::transient(cases, rtol, args.json)?)?;
    Ok(Exit::Done)
}

/// Error: the tolerance is outside the range of the method.
#[derive(Debug, thiserror::Error)]
#[error("expected a number from 1e-14 to 1e-2")]
struct ToleranceError;

/// Reads `--rtol`.
fn tolerance(text: &str) -> Result<f64, ToleranceError> {
    match text.parse::<f64>() {
        Ok(value) if (1e-14..=1e-2).contains(&value) => Ok(value),
        Ok(_) | Err(_) => Err(ToleranceError),
    }
}

fn listed(as_json: bool) -> String {
    let one = |study: &Study| {
        let (usual, value) = (study.usual(), study.to_possible_value()?);
        let about = value
            .get_help()
            .map(ToString::to_string)
            .unwrap_or_default();
        if as_json {
            let (lots, parts) = usual.unzip();
            let it =
                json!({"study": value.get_name(), "about": about, "lots": lots, "parts": parts});
            Some(format!("{it}\n"))
        } else {
            let size = usual.map_or_else(String::new, |(lots, parts)| {
                format!(" ({lots} x {parts} parts)")
            });
            Some(format!("{:<10} {about}{size}\n", value.get_name()))
        }
    };
    Study::value_variants().iter().filter_map(one).collect()
}

fn written(path: &Path, text: &str) -> anyhow::Result<()> {
    std::fs::write(path, text).with_context(|| format!("writing {}", path.display()))
}

/// Prints `text` on stdout; a closed pipe is no error.
fn print(text: &str) -> anyhow::Result<()> {
    let written = std::io::stdout().lock().write_all(text.as_bytes());
    super::unless_pipe_closed(written.context("writing the figures"), ())
}
