//! A PostgreSQL server under an unprivileged user, with its own data directory, on a loopback port.

use config::{FleetTarget, SampleChoice, TlsChoice};
use std::net::TcpListener;
use std::path::PathBuf;
use std::process::{Command, Output};
use std::time::{Duration, Instant};
use tokio_postgres::{Client, NoTls};

/// A running server; it stops when this value is dropped.
pub struct Server {
    bin: PathBuf,
    folder: tempfile::TempDir,
    /// Port on 127.0.0.1.
    pub port: u16,
}

impl Server {
    /// Makes a server with an empty database `relayrig`. Everybody on this computer may be every user.
    pub fn start() -> Self {
        let bin = programs();
        let folder = tempfile::Builder::new()
            .prefix("fleet-server-")
            .tempdir_in("/tmp")
            .unwrap();
        if is_root() {
            done(Command::new("chown").arg("postgres").arg(folder.path()));
        }
        let port = TcpListener::bind("127.0.0.1:0")
            .unwrap()
            .local_addr()
            .unwrap()
            .port();
        let server = Self { bin, folder, port };
        done(
            server
                .program("initdb")
                .args([
                    "--auth=trust",
                    "--username=owner",
                    "--encoding=UTF8",
                    "--no-sync",
                ])
                .arg("-D")
                .arg(server.data()),
        );
        server.begin();
        done(
            server
                .program("createdb")
                .args(["-h", "127.0.0.1", "-U", "owner", "-p"])
                .arg(port.to_string())
                .arg("relayrig"),
        );
        server
    }

    /// Starts the server again after [`Server::kill`]; waits until it answers.
    pub fn begin(&self) {
        let options = format!(
            "-p {} -c listen_addresses=127.0.0.1 -c unix_socket_directories='' -c max_connections=100",
            self.port
        );
        let deadline = Instant::now() + Duration::from_secs(60);
        loop {
            let started = self
                .program("pg_ctl")
                .args(["start", "-w", "-t", "60", "-l"])
                .arg(self.folder.path().join("log"))
                .arg("-D")
                .arg(self.data())
                .arg("-o")
                .arg(&options)
                .output()
                .unwrap();
            // After a kill the shared memory stays in use until the last backend has noticed.
            if started.status.success() {
                return;
            }
            assert!(
                Instant::now() < deadline,
                "{}",
                String::from_utf8_lossy(&started.stderr)
            );
        }
    }

    /// Kills the server at once (-9).
    pub fn kill(&self) {
        let pid = std::fs::read_to_string(self.data().join("postmaster.pid")).unwrap();
        done(
            Command::new("kill")
                .arg("-9")
                .arg(pid.lines().next().unwrap()),
        );
    }

    fn data(&self) -> PathBuf {
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

    /// Returns the target by which `user` reaches the server at `port`.
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
    pub fn owner(&self) -> FleetTarget {
        self.target("owner", self.port)
    }

    /// Connects as the owner.
    pub async fn client(&self) -> Client {
        let (client, connection) = tokio_postgres::connect(&self.owner().url, NoTls)
            .await
            .unwrap();
        tokio::spawn(connection);
        client
    }

    /// Returns the single number that a statement gives.
    pub async fn number(&self, sql: &str) -> i64 {
        self.client()
            .await
            .query_one(sql, &[])
            .await
            .unwrap()
            .get(0)
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self
            .program("pg_ctl")
            .args(["stop", "-m", "immediate", "-D"])
            .arg(self.data())
            .output();
    }
}

/// Returns the directory of the programs of the server.
fn programs() -> PathBuf {
    const NEEDED: [&str; 3] = ["initdb", "pg_ctl", "createdb"];
    let debian = std::fs::read_dir("/usr/lib/postgresql")
        .into_iter()
        .flatten()
        .flatten();
    let mut bins: Vec<PathBuf> = debian.map(|it| it.path().join("bin")).collect();
    bins.sort_unstable_by(|one, other| other.cmp(one));
    bins.extend(
        std::env::var_os("PATH")
            .iter()
            .flat_map(std::env::split_paths),
    );
    let found = bins
        .into_iter()
        .find(|bin| NEEDED.iter().all(|it| bin.join(it).exists()));
    found.expect("no PostgreSQL server: install the Debian package postgresql (apt-get install -y postgresql)")
}

fn is_root() -> bool {
    std::fs::metadata("/proc/self").is_ok_and(|it| std::os::unix::fs::MetadataExt::uid(&it) == 0)
}

fn done(command: &mut Command) -> Output {
    let output = command.output().unwrap();
    assert!(
        output.status.success(),
        "{command:?}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    output
}
