//! `fleet serve`: the page of all rigs of a database, which only reads.

use crate::cli::serve::PageArgs;
use app::exit::Exit;
use app::fleet_page::FleetPage;
use clap::Args;
use config::{FleetSettings, FleetTarget};

#[derive(Debug, Args)]
pub(super) struct ServeArgs {
    #[command(flatten)]
    page: PageArgs,
}

pub(super) fn run(
    (settings, targets): (&FleetSettings, &[FleetTarget]),
    args: &ServeArgs,
) -> anyhow::Result<Exit> {
    let [target] = targets else {
        let urls: Vec<&str> = targets.iter().map(|it| it.url.as_str()).collect();
        anyhow::bail!(
            "--target: found none, expected the database to show, one of {}",
            urls.join(", ")
        );
    };
    let listener = args.page.listener()?;
    FleetPage::new(listener, settings, target.clone()).run(|url| {
        eprintln!(
            "relayrig: page of all rigs at {url}, from {}, Ctrl-C stops",
            target.url
        );
    })
}
