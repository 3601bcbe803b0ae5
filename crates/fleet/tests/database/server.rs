//! A PostgreSQL server for tests.

use config::FleetTarget;
use fleet::trial::Trial;
use tokio_postgres::{Client, NoTls};

/// A running server; it stops when this value is dropped.
pub struct Server {
    trial: Trial,
    /// Port on 127.0.0.1.
    pub port: u16,
}

impl Server {
    /// Makes a server with an empty database `relayrig`. Anyone on this computer may log in as any user.
    pub fn start() -> Self {
        let trial = Trial::start().unwrap();
        let port = trial.port;
        Self { trial, port }
    }

    /// Starts the server again after [`Server::kill`]; waits until it answers.
    pub fn begin(&self) {
        self.trial.begin().unwrap();
    }

    /// Kills the server at once (-9).
    pub fn kill(&self) {
        self.trial.kill().unwrap();
    }

    /// Returns the target by which `user` reaches the server at `port`.
    pub fn target(&self, user: &str, port: u16) -> FleetTarget {
        self.trial.target(user, port)
    }

    /// Returns the target of the owner.
    pub fn owner(&self) -> FleetTarget {
        self.trial.owner()
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
