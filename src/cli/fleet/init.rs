//! `fleet init`: makes the schema with its roles and partitions.

use crate::cli::output::Output;
use app::exit::Exit;
use clap::Args;
use config::FleetTarget;

#[derive(Debug, Args)]
pub(super) struct InitArgs {
    /// User who owns the schema, instead of the user in the URL
    #[arg(long, value_name = "NAME")]
    user: Option<String>,
}

pub(super) fn run(targets: &[FleetTarget], args: &InitArgs) -> anyhow::Result<Exit> {
    let mut out = Output::stdout();
    for target in targets {
        let target = by_user(target, args.user.as_deref());
        let done = super::block_on(async { Ok(fleet::set_up(&target).await?) })?;
        out.line(&format!(
            "{}: schema {} (was {}), {} partitions made; grant relayrig_writer to the user of each rig, relayrig_reader \
             to readers",
            target.url, done.to, done.from, done.partitions
        ))?;
    }
    Ok(Exit::Done)
}

/// Returns the target with another user in its URL.
fn by_user(target: &FleetTarget, user: Option<&str>) -> FleetTarget {
    let mut target = target.clone();
    if let Some((user, (scheme, rest))) = user.zip(target.url.split_once("://")) {
        let place = rest.split_once('@').map_or(rest, |(_, place)| place);
        target.url = format!("{scheme}://{user}@{place}");
    }
    target
}
