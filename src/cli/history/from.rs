//! `--from`: a database with many rigs answers in place of the history file.

use app::order::Files;
use clap::Args;
use history::Archive;
use std::path::{Path, PathBuf};

/// Where the answers come from.
#[derive(Debug, Args)]
#[command(next_help_heading = "Database of the fleet")]
pub(super) struct FromArgs {
    /// Ask this database (postgres://USER@HOST:PORT/DATABASE) instead of the history file
    #[arg(long, global = true, value_name = "URL")]
    from: Option<String>,
    /// Only this rig
    #[arg(long, global = true, value_name = "NAME")]
    rig: Option<String>,
    /// Only rigs of this plant
    #[arg(long, global = true, value_name = "NAME")]
    site: Option<String>,
    /// PEM certificate of the authority that issued the database's certificate; when absent, that of fleet.toml
    #[arg(long, global = true, value_name = "FILE")]
    ca: Option<PathBuf>,
    /// Do not encrypt; only for a network of your own
    #[arg(long, global = true, conflicts_with = "ca")]
    no_tls: bool,
}

impl FromArgs {
    /// Opens the history file, or the database.
    ///
    /// # Errors
    /// Fails when the history cannot be read, and for an option that is valid only with --from.
    pub fn open(&self, files: &Files) -> anyhow::Result<Archive> {
        match &self.from {
            Some(url) => self.database(files, url),
            None => {
                self.check_alone()?;
                Ok(Archive::open(&files.db)?)
            }
        }
    }

    /// Returns the history file `db` if the answers come from it; `None` with --from.
    pub fn file<'a>(&self, db: &'a Path) -> Option<&'a Path> {
        self.from.is_none().then_some(db)
    }

    /// Refuses --from for a command that works on the file of a rig.
    ///
    /// # Errors
    /// Fails with --from, and with an option that is valid only with --from.
    pub fn refuse(&self, command: &str) -> anyhow::Result<()> {
        anyhow::ensure!(
            self.from.is_none(),
            "--from: `history {command}` works on the history file of a rig alone; run it there"
        );
        self.check_alone()
    }

    fn check_alone(&self) -> anyhow::Result<()> {
        let given = [
            ("rig", self.rig.is_some()),
            ("site", self.site.is_some()),
            ("ca", self.ca.is_some()),
            ("no-tls", self.no_tls),
        ];
        let alone = given.into_iter().find(|(_, given)| *given);
        if let Some((name, _)) = alone {
            anyhow::bail!(
                "--{name}: expected --from with a database too; a history file is of one rig"
            );
        }
        Ok(())
    }

    #[cfg(not(feature = "fleet"))]
    fn database(&self, _: &Files, _: &str) -> anyhow::Result<Archive> {
        anyhow::bail!("--from: this program was built without the feature `fleet`")
    }

    #[cfg(feature = "fleet")]
    fn database(&self, files: &Files, url: &str) -> anyhow::Result<Archive> {
        let rigs = fleet::Rigs {
            site: self.site.clone(),
            rig: self.rig.clone(),
        };
        let target = self.target(files, url)?;
        let reader = fleet::Reader::open(&target, &rigs)?;
        Ok(Archive::of_server(Box::new(reader)))
    }

    /// Returns the database with the encryption of --ca or --no-tls, else with that of `fleet.toml` for the same server
    /// and database, whatever the user.
    #[cfg(feature = "fleet")]
    fn target(&self, files: &Files, url: &str) -> anyhow::Result<config::FleetTarget> {
        let place = |url: &str| {
            url.rsplit_once('@')
                .map_or(url, |(_, place)| place)
                .to_owned()
        };
        let known = config::load_fleet(&files.config)?.targets;
        let known = known.into_iter().find(|it| place(&it.url) == place(url));
        let mut target = known.unwrap_or_default();
        url.clone_into(&mut target.url);
        if self.ca.is_some() || self.no_tls {
            target.ca.clone_from(&self.ca);
            target.tls = match self.no_tls {
                true => config::TlsChoice::Off,
                false => config::TlsChoice::Verify,
            };
        }
        Ok(target)
    }
}
