//! `relayrig sim`: only the simulated rig, on pseudo-terminals in real time.

use anyhow::Context;
use app::controls::Interrupts;
use app::exit::Exit;
use app::simulated;
use app::truth_file::TruthFile;
use config::Folder;
use rigsim::Options;
use rigsim::fault::FaultInfo;
use rigsim::pty::{self, Rates};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The simulated rig.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  relayrig sim --link /tmp/rig
  relayrig run --lot A --recipe jzc-22f-012 --count 5 --line measure=/tmp/rig/measure --line motion=/tmp/rig/motion
  relayrig sim --bench modules.toml
  relayrig sim --bench modules.toml --heed-baud
  relayrig sim --bench modules.toml --fault flip=0.05 --fault late=0.01/350
  relayrig sim --instruments bench.toml --fault reply_late=smu:0.01/1500
  relayrig sim --fault port_lost=motion@20..23
  relayrig sim --faults

A fault is NAME[=VALUE[@FROM[..UNTIL]]]: FROM and UNTIL in seconds of rig time. Several faults combine.")]
pub struct SimArgs {
    /// Seed of rig and lot
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// World instead of config/sim.toml
    #[arg(long, value_name = "FILE")]
    pub world: Option<PathBuf>,
    /// Recipe whose parts are in the magazine [default: jzc-22f-012, ssr-dc-60v-3a or thermostat-ksd9700 where the rig
    /// has it, else its first one]
    #[arg(long, value_name = "NAME")]
    pub recipe: Option<String>,
    /// Fault by name
    #[arg(long, value_name = "NAME[=VALUE]")]
    pub fault: Vec<String>,
    /// Write the true values of every part into this file: as parts land, and at the end for those still inside
    #[arg(long, value_name = "FILE")]
    pub truth: Option<PathBuf>,
    /// A symlink per line in this directory
    #[arg(long, value_name = "DIR")]
    pub link: Option<PathBuf>,
    /// No rig: the modules of this file on one pseudo-terminal (docs/bench.md has every key)
    #[arg(long, value_name = "FILE", conflicts_with_all = ["world", "truth"])]
    pub bench: Option<PathBuf>,
    /// No rig: the SCPI instruments of this file on sockets and pseudo-terminals (docs/instruments.md has every key)
    #[arg(long, value_name = "FILE", conflicts_with_all = ["world", "truth", "bench", "link", "heed_baud", "journal"])]
    pub instruments: Option<PathBuf>,
    /// A module answers only at its own rate, as on a wire; without this option it answers at every rate
    #[arg(long)]
    pub heed_baud: bool,
    /// Print the journal of the rig (changes of outputs, faults, expired host watchdogs), one JSON object per line
    #[arg(long)]
    pub journal: bool,
    /// Names of all faults with unit and default
    #[arg(long)]
    pub faults: bool,
}

/// Runs `relayrig sim` until it is interrupted.
pub fn run(config: &Folder, args: &SimArgs) -> anyhow::Result<Exit> {
    let files = simulated::files(config);
    if let Some(file) = &args.instruments
        && !args.faults
    {
        return serve_instruments(file, args);
    }
    if args.bench.is_none() {
        config.check_exists()?;
    }
    if args.faults {
        let faults = rigsim::faults(&files, args.world.as_deref())?;
        let row = |fault: FaultInfo| {
            format!(
                "{:<14} {:<30} default {:<12} {}\n",
                fault.name, fault.unit, fault.default, fault.what
            )
        };
        let rows: String = faults.into_iter().map(row).collect();
        let written = std::io::stdout().write_all(rows.as_bytes());
        super::unless_pipe_closed(written.context("writing the faults"), ())?;
        return Ok(Exit::Done);
    }
    let rig = match &args.bench {
        Some(file) => rigsim::build_bench(file, &args.fault)?,
        None => rigsim::build(&Options {
            world: args.world.clone(),
            seed: args.seed,
            recipe: args
                .recipe
                .clone()
                .unwrap_or_else(|| super::rig::usual_recipe(config)),
            files,
            parts: None,
            reference_parts: true,
            faults: args.fault.clone(),
        })?,
    };
    let rates = if args.heed_baud {
        Rates::Enforced
    } else {
        Rates::Ignored
    };
    let ptys = pty::serve(&rig, rates)?;
    if let Some(dir) = &args.link {
        ptys.link(dir)?;
    }
    let lines: serde_json::Map<String, Value> = ptys
        .paths()
        .into_iter()
        .map(|(name, path)| (name, json!(path.to_string_lossy())))
        .collect();
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()?;
    let mut truth = args.truth.as_deref().map(TruthFile::create).transpose()?;
    runtime.block_on(async {
        let served = rig.serve_instruments().await?;
        let links: BTreeMap<String, String> = served.links.iter().cloned().collect();
        match links.is_empty() {
            true => println!("{}", json!({ "lines": lines })),
            false => println!("{}", json!({ "lines": lines, "instruments": links })),
        }
        if args.journal {
            print_journal(rig.journal());
        }
        wait(|| match &mut truth {
            Some(file) => file.write_landed(&rig),
            None => Ok(()),
        })
        .await
    })?;
    ptys.stop();
    if let Some(file) = &mut truth {
        file.write_rest(&rig)?;
    }
    Ok(Exit::Done)
}

/// Serves the instruments of a file until the command is interrupted.
fn serve_instruments(file: &Path, args: &SimArgs) -> anyhow::Result<Exit> {
    let bench = rigsim::scpi::file::build(file, args.seed, &args.fault)?;
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()?;
    runtime.block_on(async {
        let mut interrupts = Interrupts::listen()?;
        let served = rigsim::scpi::serve::real_time(&bench).await?;
        let links: BTreeMap<String, String> = served.links.iter().cloned().collect();
        println!("{}", json!({ "instruments": links }));
        interrupts.next().await;
        Ok(Exit::Done)
    })
}

/// Prints the journal of the rig until the program ends.
fn print_journal(journal: std::sync::mpsc::Receiver<rigsim::journal::Entry>) {
    std::thread::spawn(move || {
        let mut out = std::io::stdout();
        for entry in journal {
            // The reader has closed the pipe.
            if writeln!(out, "{}", json!(entry)).is_err() {
                return;
            }
        }
    });
}

/// Waits for Ctrl-C or a termination signal and calls `meanwhile` twice a second.
async fn wait(mut meanwhile: impl FnMut() -> anyhow::Result<()>) -> anyhow::Result<()> {
    let mut interrupts = Interrupts::listen()?;
    let mut beat = tokio::time::interval(Duration::from_millis(500));
    loop {
        tokio::select! {
            () = interrupts.next() => return Ok(()),
            _ = beat.tick() => meanwhile()?,
        }
    }
}
