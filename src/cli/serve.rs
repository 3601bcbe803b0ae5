//! `relayrig serve`: runs lot after lot on the rig, as its page orders; see [`Service`].

use super::rig::{PaceArg, RigArgs};
use super::terminal::{Rows, Terminal};
use anyhow::bail;
use app::exit::Exit;
use app::order::{Files, LotOrder};
use app::service::Service;
use std::net::SocketAddr;

/// Serves the page and runs the lots that it orders.
#[derive(Debug, clap::Args)]
#[command(
    mut_arg("pace", |pace| pace.default_value("real").hide(true)),
    after_help = "Examples:
  relayrig serve --line measure=/dev/ttyUSB0 --line motion=/dev/ttyUSB1
  relayrig serve --listen 127.0.0.1:9000 --sim --speed 5

Exit status: 0 ended between lots, 2 bad input, 3 the rig has trouble, 4 a lot was stopped."
)]
pub struct ServeArgs {
    /// Address of the page
    #[arg(long, value_name = "ADDR", default_value = "127.0.0.1:8080")]
    pub listen: SocketAddr,
    /// The rig.
    #[command(flatten)]
    pub rig: RigArgs,
}

/// Runs the command, with `first` as its first lot.
pub fn run(files: &Files, args: &ServeArgs, first: Option<LotOrder>) -> anyhow::Result<Exit> {
    let mut rig = args.rig.clone();
    if rig.speed.is_some() {
        rig.pace = PaceArg::Virtual;
    } else if rig.sim && rig.pace == PaceArg::Virtual {
        bail!(
            "--pace virtual: found without --speed, expected both: an idle rig in virtual time runs ahead of the clock"
        );
    }
    let mut service = Service::open(files, rig.source(None)?, args.listen, first)?;
    if let Some(first) = service.take_first_login() {
        eprintln!(
            "relayrig: log in as {} with {} (shown once; the register is {})",
            first.name,
            first.password,
            first.people.display()
        );
    }
    eprintln!(
        "relayrig: {}page at http://{}/, history in {}, Ctrl-C stops",
        if rig.sim {
            "simulated rig running, "
        } else {
            ""
        },
        service.address(),
        files.db.display()
    );
    service.run(&mut Terminal::new(Rows::Table))
}
