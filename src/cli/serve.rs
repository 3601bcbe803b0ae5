//! `relayrig serve`: runs lot after lot on the rig, as people order at its page; see [`Service`].

use super::rig::{PaceArg, RigArgs};
use super::terminal::{Rows, Terminal};
use anyhow::bail;
use app::exit::Exit;
use app::order::{Files, LotOrder};
use app::service::Service;
use page::{ListenError, Listener, Tls};
use std::net::SocketAddr;
use std::path::PathBuf;

/// Serves the page and runs the lots that people order there.
#[derive(Debug, clap::Args)]
#[command(
    mut_arg("pace", |pace| pace.default_value("real").hide(true)),
    after_help = "Examples:
  relayrig serve --line measure=/dev/ttyUSB0 --line motion=/dev/ttyUSB1
  relayrig serve --listen 127.0.0.1:9000 --sim --speed 5
  relayrig serve --listen 0.0.0.0:8443 --tls-cert cert.pem --tls-key key.pem

Exit status: 0 ended between lots, 2 bad input, 3 the rig has trouble, 4 a lot was stopped."
)]
pub struct ServeArgs {
    /// Where the page listens.
    #[command(flatten)]
    pub page: PageArgs,
    /// The rig.
    #[command(flatten)]
    pub rig: RigArgs,
}

/// Where the page listens.
#[derive(Debug, Clone, clap::Args)]
pub struct PageArgs {
    /// Address of the page; an address that other computers can reach needs --tls-cert and --tls-key
    #[arg(long, value_name = "ADDR", default_value = "127.0.0.1:8080")]
    listen: SocketAddr,
    /// PEM file with the certificate of the page, then those of its issuers; turns the page to https
    #[arg(long, value_name = "FILE", requires = "tls_key")]
    tls_cert: Option<PathBuf>,
    /// Private key of the certificate, PEM without password
    #[arg(long, value_name = "FILE", requires = "tls_cert")]
    tls_key: Option<PathBuf>,
}

impl PageArgs {
    /// Opens the socket.
    ///
    /// # Errors
    /// Fails as [`Listener::open`] does.
    pub fn listener(&self) -> Result<Listener, ListenError> {
        let files = self.tls_cert.as_ref().zip(self.tls_key.as_ref());
        let tls = files.map(|(cert, key)| Tls::load(cert, key)).transpose()?;
        Listener::open(self.listen, tls)
    }
}

/// Runs `relayrig serve`, with `first` as its first lot.
pub fn run(files: &Files, args: &ServeArgs, first: Option<LotOrder>) -> anyhow::Result<Exit> {
    let mut rig = args.rig.clone();
    if rig.speed.is_some() {
        rig.pace = PaceArg::Virtual;
    } else if rig.sim && rig.pace == PaceArg::Virtual {
        bail!(
            "--pace virtual: found without --speed, expected both: an idle rig in virtual time runs ahead of the clock"
        );
    }
    let service = Service::open(files, rig.source(None)?, args.page.listener()?, first)?;
    if let Some(code) = service.setup_code() {
        eprintln!(
            "relayrig: no engineer yet: press log in at the page and give the set-up code {code}, or run \
             `relayrig --db {} user add NAME --role engineer`",
            files.db.display()
        );
    }
    eprintln!(
        "relayrig: {}page at {}, history in {}, Ctrl-C stops",
        if rig.sim {
            "simulated rig running, "
        } else {
            ""
        },
        service.url(),
        files.db.display()
    );
    service.run(&mut Terminal::new(Rows::Table))
}
