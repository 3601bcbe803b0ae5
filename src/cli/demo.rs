//! `relayrig demo`: the main job with nothing to prepare.

use super::run::{self, Controls, PaceArg, RunArgs};
use std::path::Path;

/// The main job with nothing to prepare.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  relayrig demo
  relayrig demo --listen 127.0.0.1:9000 --fault fall")]
pub struct DemoArgs {
    /// Where the page listens
    #[arg(long, value_name = "ADDR", default_value = "127.0.0.1:8080")]
    pub listen: std::net::SocketAddr,
    /// Fault of the simulated rig, see `relayrig sim --faults`
    #[arg(long, value_name = "NAME[=VALUE]")]
    pub fault: Vec<String>,
    /// Draws rig and lot
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Parts of the lot; without it the lot goes on until it is stopped
    #[arg(long, value_name = "N")]
    pub count: Option<u64>,
}

/// Runs the command; the result is the exit status.
pub fn run(config: &Path, db: &Path, args: &DemoArgs) -> anyhow::Result<i32> {
    let controls = Controls::new(false);
    let lot = format!("demo {}", jiff::Zoned::now().strftime("%Y-%m-%d %H:%M:%S"));
    let order = RunArgs {
        sim: true,
        pace: PaceArg::Real,
        lot,
        recipe: "jzc-22f-012".into(),
        count: args.count,
        seed: args.seed,
        world: None,
        fault: args.fault.clone(),
        truth: None,
        line: Vec::new(),
        json: false,
    };
    run::run_with(config, db, &order, &controls)
}
