//! A PostgreSQL server for tests and studies: under an unprivileged user, with a data directory of its own, on a
//! loopback port. Needs the Debian package `postgresql` (15 or later).

use config::{FleetTarget, SampleChoice, TlsChoice};
use std::io::{Error, Result};
use std::net::TcpListener;
use std::path::PathBuf;
use std::process::{Command, Output};
use std::time::{Duration, Instant};

/// Longest wait for the server, seconds.
const START_S: u64 = 60;

/// A running server; the drop of this value stops the server and deletes its data.
#[derive(Debug)]
pub struct Trial {
    bin: PathBuf,
    folder: tempfile::TempDir,
    /// Port on 127.0.0.1.
    pub port: u16,
}

impl Trial {
    /// Makes a server with an empty database `relayrig`. Everybody on this computer may log in as any user of the
    /// database.
    ///
    /// # Errors
    /// Fails when the programs of the server are missing or do not start.
    pub fn start() -> Result<Self> {
        let bin = programs()?;
        let folder = tempfile::Builder::new()
            .prefix("fleet-server-")
            .tempdir_in("/tmp")?;
        if is_root() {
            done(Command::new("chown").arg("postgres").arg(folder.path()))?;
        }
        let port = TcpListener::bind("127.0.0.1:0")?.local_addr()?.port();
        let trial = Self { bin, folder, port };
        let settings = [
            "--auth=trust",
            "--username=owner",
            "--encoding=UTF8",
            "--no-sync",
        ];
        let data = trial.data();
        done(trial.program("initdb").args(settings).arg("-D").arg(data))?;
        trial.begin()?;
        done(trial.client("createdb").arg("relayrig"))?;
        Ok(trial)
    }

    /// Starts the server again after [`Trial::kill`]; waits until it answers.
    ///
    /// # Errors
    /// Fails when the server does not answer within a minute.
    pub fn begin(&self) -> Result<()> {
        let options = format!(
            "-p {} -c listen_addresses=127.0.0.1 -c unix_socket_directories='' -c max_connections=100 \
             -c shared_buffers=256MB -c max_wal_size=4GB",
            self.port
        );
        let deadline = Instant::now() + Duration::from_secs(START_S);
        loop {
            let started = self
                .program("pg_ctl")
                .args(["start", "-w", "-t", "60", "-l"])
                .arg(self.folder.path().join("log"))
                .arg("-D")
                .arg(self.data())
                .arg("-o")
                .arg(&options)
                .output()?;
            // After a kill the shared memory stays in use until the last backend has noticed.
            if started.status.success() {
                return Ok(());
            }
            if Instant::now() > deadline {
                return Err(Error::other(text(&started.stderr)));
            }
        }
    }

    /// Kills the server at once (-9).
    ///
    /// # Errors
    /// Fails when the server does not run.
    pub fn kill(&self) -> Result<()> {
        let file = std::fs::read_to_string(self.data().join("postmaster.pid"))?;
        let pid = file.lines().next().unwrap_or_default();
        done(Command::new("kill").arg("-9").arg(pid)).map(drop)
    }

    /// Returns the command of a client program, such as psql, for the owner of the server.
    #[must_use]
    pub fn client(&self, name: &str) -> Command {
        let mut command = self.program(name);
        command
            .args(["-h", "127.0.0.1", "-U", "owner", "-p"])
            .arg(self.port.to_string());
        command
    }

    /// Returns the target by which `user` reaches the server at `port`.
    #[must_use]
    pub fn target(&self, user: &str, port: u16) -> FleetTarget {
        FleetTarget {
            url: format!("postgres://{user}@127.0.0.1:{port}/relayrig"),
            tls: TlsChoice::Off,
            ca: None,
            samples: SampleChoice::All,
            alarm_after_s: 60,
        }
    }

    /// Returns the target of the owner.
    #[must_use]
    pub fn owner(&self) -> FleetTarget {
        self.target("owner", self.port)
    }

    /// Returns the folder of the data.
    #[must_use]
    pub fn data(&self) -> PathBuf {
        self.folder.path().join("data")
    }

    fn program(&self, name: &str) -> Command {
        let path = self.bin.join(name);
        let mut command = if is_root() {
            let mut command = Command::new("setpriv");
            command
                .args(["--reuid=postgres", "--regid=postgres", "--clear-groups"])
                .arg(path);
            command
        } else {
            Command::new(path)
        };
        command.current_dir("/");
        command
    }
}

impl Drop for Trial {
    fn drop(&mut self) {
        let stop = ["stop", "-m", "immediate", "-D"];
        // The folder is deleted even if the server does not stop.
        let _ = self.program("pg_ctl").args(stop).arg(self.data()).output();
    }
}

/// Returns the directory of the programs of the server.
fn programs() -> Result<PathBuf> {
    const NEEDED: [&str; 3] = ["initdb", "pg_ctl", "createdb"];
    let debian = std::fs::read_dir("/usr/lib/postgresql")
        .into_iter()
        .flatten()
        .flatten();
    let mut bins: Vec<PathBuf> = debian.map(|it| it.path().join("bin")).collect();
    bins.sort_unstable_by(|one, other| other.cmp(one));
    let path = std::env::var_os("PATH");
    bins.extend(path.iter().flat_map(std::env::split_paths));
    let mut bins = bins.into_iter();
    let found = bins.find(|bin| NEEDED.iter().all(|it| bin.join(it).exists()));
    found.ok_or_else(|| {
        Error::other(
            "found no PostgreSQL server, expected the Debian package postgresql (apt-get install -y postgresql)",
        )
    })
}

fn is_root() -> bool {
    std::fs::metadata("/proc/self").is_ok_and(|it| std::os::unix::fs::MetadataExt::uid(&it) == 0)
}

/// Runs a command to its end.
///
/// # Errors
/// Fails when the command does not start, and with its output on stderr when it ends with an error.
pub fn done(command: &mut Command) -> Result<Output> {
    let output = command.output()?;
    match output.status.success() {
        true => Ok(output),
        false => Err(Error::other(format!(
            "{command:?}: {}",
            text(&output.stderr)
        ))),
    }
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}
