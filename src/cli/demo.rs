//! `relayrig demo`: the main job with nothing to prepare, which is [`serve`] over the simulated rig with a first lot
//! that starts by itself.

use super::rig::{self, PaceArg, RigArgs};
use super::run::RunArgs;
use super::serve::{self, ServeArgs};
use std::path::Path;

/// The main job with nothing to prepare.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  relayrig demo
  relayrig demo --listen 127.0.0.1:9000 --fault fall
  relayrig demo --speed 5")]
pub struct DemoArgs {
    /// Where the page listens
    #[arg(long, value_name = "ADDR", default_value = "127.0.0.1:8080")]
    pub listen: std::net::SocketAddr,
    /// Fault of the simulated rig, see `relayrig sim --faults`
    #[arg(long, value_name = "NAME[=VALUE]")]
    pub fault: Vec<String>,
    /// In virtual time at X times the speed of the wall clock, instead of through pseudo-terminals
    #[arg(long, value_name = "X", value_parser = rig::speed)]
    pub speed: Option<f64>,
    /// Draws rig and lot
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Parts of the lot; without it the lot goes on until it is stopped
    #[arg(long, value_name = "N")]
    pub count: Option<u64>,
}

/// Runs the command; the result is the exit status.
pub fn run(config: &Path, db: &Path, args: &DemoArgs) -> anyhow::Result<i32> {
    let rig = RigArgs {
        sim: true,
        pace: PaceArg::Real,
        speed: args.speed,
        seed: args.seed,
        world: None,
        fault: args.fault.clone(),
        line: Vec::new(),
    };
    let first = RunArgs {
        rig: rig.clone(),
        lot: format!("demo {}", jiff::Zoned::now().strftime("%Y-%m-%d %H:%M:%S")),
        recipe: "jzc-22f-012".into(),
        count: args.count,
        truth: None,
        retest: None,
        json: false,
        study: None,
    };
    let listen = args.listen;
    serve::day(config, db, &ServeArgs { listen, rig }, Some(first))
}
