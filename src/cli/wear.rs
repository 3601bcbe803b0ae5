//! `relayrig wear`: use counts of probes and jaws since their last replacement.

use super::output::Output;
use super::person;
use app::exit::Exit;
use history::{Store, Wear};
use serde_json::json;
use std::path::Path;

/// Lists or resets the counters.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  relayrig wear list
  relayrig wear replaced probe_touches --by li

Limits are [wear] of lot.toml; at a limit the line goes on and warns.")]
pub struct WearArgs {
    /// Counters of the simulated rig
    #[arg(long, global = true)]
    sim: bool,
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, clap::Subcommand)]
enum Action {
    /// List every counter
    #[command(after_help = "Example: relayrig wear list --json")]
    List {
        /// One JSON object per counter
        #[arg(long)]
        json: bool,
    },
    /// Reset the counter of a replaced part
    #[command(after_help = "Example: relayrig wear replaced probe_touches --by li")]
    Replaced {
        /// Name of the counter
        name: String,
        /// Person who replaced the part
        #[arg(long, value_name = "NAME")]
        by: String,
    },
}

/// Runs `relayrig wear`; an error is bad input (exit status 2).
pub fn run(db: &Path, args: &WearArgs) -> anyhow::Result<Exit> {
    let mut store = Store::open(db)?;
    match &args.action {
        Action::List { json } => list(&store, args.sim, *json)?,
        Action::Replaced { name, by } => {
            let by = person(by)?.who;
            let at_us = jiff::Timestamp::now().as_microsecond();
            if !store.replaced(args.sim, name, &by, at_us)? {
                let known = store.wear(args.sim)?;
                let known: Vec<&str> = known.iter().map(|it| it.name.as_str()).collect();
                eprintln!(
                    "relayrig: found no counter {name:?}, expected one of {}",
                    known.join(", ")
                );
                return Ok(Exit::BadInput);
            }
        }
    }
    Ok(Exit::Done)
}

fn list(store: &Store, sim: bool, as_json: bool) -> anyhow::Result<()> {
    let row = |it: &Wear| {
        let replaced = match (&it.replaced, &it.replaced_by) {
            (Some(at), Some(by)) => format!("replaced {} by {by}", at.local()),
            (_, _) => "never replaced".to_owned(),
        };
        format!("{:<16}{:>10}  {replaced}", it.name, it.count)
    };
    Ok(Output::stdout().lines(as_json, &store.wear(sim)?, |it| json!(it), row)?)
}
