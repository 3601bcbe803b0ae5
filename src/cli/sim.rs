//! `relayrig sim`: only the simulated rig, on pseudo-terminals in real time.

use anyhow::anyhow;
use rigsim::{Options, SharedRig, pty};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// The simulated rig.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  relayrig sim --link /tmp/rig
  relayrig run --lot A --recipe jzc-22f-012 --count 5 --line measure=/tmp/rig/measure --line motion=/tmp/rig/motion
  relayrig sim --bench modules.toml
  relayrig sim --faults")]
pub struct SimArgs {
    /// Draws rig and lot
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// World instead of config/sim.toml
    #[arg(long, value_name = "FILE")]
    pub world: Option<PathBuf>,
    /// Recipe whose parts are in the magazine
    #[arg(long, value_name = "NAME", default_value = "jzc-22f-012")]
    pub recipe: String,
    /// Fault by name
    #[arg(long, value_name = "NAME[=VALUE]")]
    pub fault: Vec<String>,
    /// True values of every specimen go to this file at the end
    #[arg(long, value_name = "FILE")]
    pub truth: Option<PathBuf>,
    /// A symlink per line in this directory
    #[arg(long, value_name = "DIR")]
    pub link: Option<PathBuf>,
    /// No rig: the modules of this file on one pseudo-terminal
    #[arg(long, value_name = "FILE", conflicts_with_all = ["world", "truth"])]
    pub bench: Option<PathBuf>,
    /// Names of all faults with unit and default
    #[arg(long)]
    pub faults: bool,
}

/// Runs the command until it is interrupted; the result is the exit status.
pub fn run(config: &Path, args: &SimArgs) -> anyhow::Result<i32> {
    if args.faults {
        for fault in rigsim::faults(config, args.world.as_deref())? {
            println!(
                "{:<20} {:<12} default {:<8} {}",
                fault.name, fault.unit, fault.default, fault.what
            );
        }
        return Ok(0);
    }
    let rig = match &args.bench {
        Some(file) => rigsim::build_bench(file, &args.fault)?,
        None => rigsim::build(&Options {
            config_dir: config.to_path_buf(),
            world: args.world.clone(),
            seed: args.seed,
            recipe: args.recipe.clone(),
            parts: None,
            golden: true,
            faults: args.fault.clone(),
        })?,
    };
    let ptys = pty::serve(&rig)?;
    if let Some(dir) = &args.link {
        ptys.link(dir)?;
    }
    let lines: serde_json::Map<String, Value> = ptys
        .paths()
        .into_iter()
        .map(|(name, path)| (name, json!(path.to_string_lossy())))
        .collect();
    println!("{}", json!({ "lines": lines }));
    wait()?;
    ptys.stop();
    write_truth(&rig, args)
}

/// Until Ctrl-C or a termination signal.
fn wait() -> anyhow::Result<()> {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()?;
    runtime.block_on(async {
        let mut terminate =
            tokio::signal::unix::signal(tokio::signal::unix::SignalKind::terminate())?;
        tokio::select! {
            interrupted = tokio::signal::ctrl_c() => interrupted?,
            _ = terminate.recv() => {}
        }
        Ok(())
    })
}

fn write_truth(rig: &SharedRig, args: &SimArgs) -> anyhow::Result<i32> {
    if let Some(path) = &args.truth {
        let lines: String = rig.truth().iter().map(|part| format!("{part}\n")).collect();
        std::fs::write(path, lines)
            .map_err(|error| anyhow!("--truth {}: {error}", path.display()))?;
    }
    Ok(0)
}
