//! `relayrig demo`: [`serve`] on the simulated rig, with a first lot that starts at once. A demo needs no preparation:
//! it brings its own configuration and has its own history.

use super::rig::{self, PaceArg, RigArgs};
use super::serve::{self, PageArgs, ServeArgs};
use app::exit::Exit;
use app::order::{Files, LotOrder};
use config::Folder;

/// Simulated rig with its page and a running lot, without preparation.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  relayrig demo
  relayrig demo --listen 127.0.0.1:9000 --fault fall
  relayrig demo --speed 5
  relayrig demo --pace real
  relayrig demo --config rig1
  relayrig demo --rig ssr

The configuration is inside the program; a directory `config` is used only with --config config. The history
relayrig-demo.db and the logins relayrig-demo-access.db appear in the current directory; --db names another place.")]
pub struct DemoArgs {
    /// Rig to simulate, of those inside the program
    #[arg(long, value_name = "NAME", default_value = "jzc-22f", value_parser = rig::built_in(), conflicts_with = "config")]
    pub rig: String,
    /// Recipe of the lot [default: jzc-22f-012, ssr-dc-60v-3a or thermostat-ksd9700 where the rig has it, else its
    /// first one]
    #[arg(long, value_name = "NAME")]
    pub recipe: Option<String>,
    /// Where the page listens.
    #[command(flatten)]
    pub page: PageArgs,
    /// Fault of the simulated rig, see `relayrig sim --faults`
    #[arg(long, value_name = "NAME[=VALUE]")]
    pub fault: Vec<String>,
    /// How the simulated rig keeps time
    #[arg(long, value_enum, default_value = "held")]
    pub pace: DemoPace,
    /// Speed of the held rig, in multiples of the wall clock (0.1 to 1000)
    #[arg(long, value_name = "X", default_value_t = 1.0, value_parser = rig::speed)]
    pub speed: f64,
    /// Seed of rig and lot
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Number of parts in the lot; when absent, the lot goes on until it is stopped
    #[arg(long, value_name = "N")]
    pub count: Option<u64>,
}

/// How the simulated rig of a demo keeps time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum DemoPace {
    /// Virtual time held to the wall clock: a busy computer slows the rig down and never stops it
    Held,
    /// Pseudo-terminals in real time, as a rig at serial ports: a busy computer is late and an alarm ends the lot
    Real,
}

/// Runs `relayrig demo`; an error is bad input (exit status 2).
pub fn run(files: &Files, args: &DemoArgs) -> anyhow::Result<Exit> {
    let rig = RigArgs {
        sim: true,
        pace: match args.pace {
            DemoPace::Held => PaceArg::Virtual,
            DemoPace::Real => PaceArg::Real,
        },
        speed: (args.pace == DemoPace::Held).then_some(args.speed),
        seed: args.seed,
        world: None,
        fault: args.fault.clone(),
        line: Vec::new(),
    };
    let first = LotOrder {
        lot: format!("demo {}", jiff::Zoned::now().strftime("%Y-%m-%d %H:%M:%S")),
        recipe: args
            .recipe
            .clone()
            .unwrap_or_else(|| rig::usual_recipe(&files.config)),
        count: args.count,
        retest: None,
    };
    if let Folder::Memory(_) = &files.config {
        eprintln!(
            "relayrig: demo with the configuration inside this program; `relayrig init DIR --rig {}` writes it for you to edit",
            args.rig
        );
    }
    let page = args.page.clone();
    serve::run(files, &ServeArgs { page, rig }, Some(first))
}
