//! A connection to a database: password, encryption, time limits, schema.

use crate::error::{Doing, FleetError, Result};
use crate::password::PasswordFile;
use crate::setup::SCHEMA;
use config::{FleetTarget, TlsChoice};
use std::time::Duration;
use tokio::task::JoinHandle;
use tokio_postgres::config::{Host, SslMode};
use tokio_postgres::types::ToSql;
use tokio_postgres::{Client, Config, NoTls, Row};

/// Longest wait for a connection.
const CONNECT: Duration = Duration::from_secs(10);
/// Longest time for one step; the server ends a statement a little earlier.
const STEP: Duration = Duration::from_secs(60);

/// A connection to a database that collects the histories of rigs.
#[derive(Debug)]
pub struct Link {
    /// Client of the library.
    pub(crate) client: Client,
    /// URL of the database without password, as messages name it.
    pub(crate) target: String,
    /// Longest time for one step.
    patience: Duration,
    /// Task that moves the bytes.
    carrier: JoinHandle<()>,
}

impl Drop for Link {
    fn drop(&mut self) {
        self.carrier.abort();
    }
}

impl Link {
    /// Connects without a check of the schema.
    ///
    /// # Errors
    /// Fails when URL, password file or certificates cannot be used, and when the server does not let this user in.
    pub async fn connect(target: &FleetTarget) -> Result<Self> {
        const DOING: &str = "connecting";
        let name = target.url.clone();
        let config = settings(target)?;
        let (client, carrier) = match target.tls {
            TlsChoice::Off => {
                let connecting = config.connect(NoTls);
                let (client, connection) = within(&name, DOING, CONNECT, connecting)
                    .await?
                    .doing(&name, DOING)?;
                (client, tokio::spawn(async move { drop(connection.await) }))
            }
            TlsChoice::Verify => encrypted(target, &config).await?,
        };
        let link = Self {
            client,
            target: name,
            patience: STEP,
            carrier,
        };
        link.step("setting time limits", link.client.batch_execute(
            "SET statement_timeout = '55s'; SET lock_timeout = '20s'; SET idle_in_transaction_session_timeout = '120s';
             SET client_min_messages = 'warning'; SET timezone = 'UTC'")).await?;
        Ok(link)
    }

    /// Connects and checks the schema.
    ///
    /// # Errors
    /// Fails as [`Link::connect`] does, and when the schema is missing, foreign or older than this program needs. A
    /// newer schema is no fault: steps only add.
    pub async fn open(target: &FleetTarget) -> Result<Self> {
        let link = Self::connect(target).await?;
        let target = link.target.clone();
        match link.schema().await? {
            None => Err(FleetError::NoSchema { target }),
            Some(found) if found < SCHEMA => Err(FleetError::SchemaOlder {
                target,
                found,
                expected: SCHEMA,
            }),
            Some(_) => Ok(link),
        }
    }

    /// Sets the longest time for one step.
    pub(crate) const fn patient(mut self, patience: Duration) -> Self {
        self.patience = patience;
        self
    }

    /// Returns the number of the schema; `None` when the database has no schema `relayrig`.
    ///
    /// # Errors
    /// Fails when the schema `relayrig` belongs to another program.
    pub(crate) async fn schema(&self) -> Result<Option<i32>> {
        const DOING: &str = "reading the schema";
        let here = self.step(DOING, self.client.query_one(
            "SELECT to_regnamespace('relayrig') IS NOT NULL, to_regclass('relayrig.schema_step') IS NOT NULL", &[])).await?;
        match (here.get(0), here.get(1)) {
            (false, _) => Ok(None),
            (true, false) => Err(FleetError::Foreign {
                target: self.target.clone(),
            }),
            (true, true) => {
                let last = "SELECT max(step) FROM relayrig.schema_step";
                Ok(self
                    .step(DOING, self.client.query_one(last, &[]))
                    .await?
                    .get(0))
            }
        }
    }

    /// Returns the only row of a statement.
    pub(crate) async fn row(
        &self,
        doing: &'static str,
        sql: &str,
        values: &[&(dyn ToSql + Sync)],
    ) -> Result<Row> {
        self.step(doing, self.client.query_one(sql, values)).await
    }

    /// Returns the rows of a statement.
    pub(crate) async fn rows(
        &self,
        doing: &'static str,
        sql: &str,
        values: &[&(dyn ToSql + Sync)],
    ) -> Result<Vec<Row>> {
        self.step(doing, self.client.query(sql, values)).await
    }

    /// Waits for a step of the server, within the time limit.
    pub(crate) async fn step<T>(
        &self,
        doing: &'static str,
        work: impl Future<Output = std::result::Result<T, tokio_postgres::Error>>,
    ) -> Result<T> {
        within(&self.target, doing, self.patience, work)
            .await?
            .doing(&self.target, doing)
    }
}

/// Waits for `work`, at most `limit`.
async fn within<T>(
    target: &str,
    doing: &'static str,
    limit: Duration,
    work: impl Future<Output = T>,
) -> Result<T> {
    tokio::time::timeout(limit, work)
        .await
        .map_err(|_| FleetError::TimeOut {
            target: target.to_owned(),
            doing,
            seconds: limit.as_secs(),
            queued: false,
        })
}

/// Makes the settings of the library from URL, environment and password file.
fn settings(target: &FleetTarget) -> Result<Config> {
    let mut config: Config = target.url.parse().map_err(|error: tokio_postgres::Error| {
        let cause = std::error::Error::source(&error).map(ToString::to_string);
        FleetError::Url {
            target: target.url.clone(),
            why: cause.unwrap_or_else(|| error.to_string()),
        }
    })?;
    config
        .application_name("relayrig")
        .connect_timeout(CONNECT)
        .keepalives_idle(Duration::from_secs(15))
        .keepalives_interval(Duration::from_secs(5))
        .keepalives_retries(3)
        .tcp_user_timeout(Duration::from_secs(30))
        .ssl_mode(match target.tls {
            TlsChoice::Verify => SslMode::Require,
            TlsChoice::Off => SslMode::Disable,
        });
    if let Some(password) = password(&config)? {
        config.password(password);
    }
    Ok(config)
}

fn password(config: &Config) -> Result<Option<String>> {
    if let Ok(password) = std::env::var("PGPASSWORD") {
        return Ok(Some(password));
    }
    let Some(file) = PasswordFile::of_environment() else {
        return Ok(None);
    };
    let host = match config.get_hosts().first() {
        Some(Host::Tcp(host)) => host.as_str(),
        Some(Host::Unix(_)) | None => "localhost",
    };
    let port = config
        .get_ports()
        .first()
        .copied()
        .unwrap_or(5432)
        .to_string();
    let user = config.get_user().unwrap_or_default();
    file.password([host, &port, config.get_dbname().unwrap_or(user), user])
}

#[cfg(not(feature = "tls"))]
async fn encrypted(target: &FleetTarget, _: &Config) -> Result<(Client, JoinHandle<()>)> {
    Err(FleetError::NoTls {
        target: target.url.clone(),
    })
}

#[cfg(feature = "tls")]
async fn encrypted(target: &FleetTarget, config: &Config) -> Result<(Client, JoinHandle<()>)> {
    const DOING: &str = "connecting over TLS";
    let tls = tokio_postgres_rustls::MakeRustlsConnect::new(client_tls(target)?);
    let connecting = within(&target.url, DOING, CONNECT, config.connect(tls)).await?;
    let (client, connection) = connecting.doing(&target.url, DOING)?;
    Ok((client, tokio::spawn(async move { drop(connection.await) })))
}

#[cfg(feature = "tls")]
fn client_tls(target: &FleetTarget) -> Result<rustls::ClientConfig> {
    use rustls::pki_types::{CertificateDer, pem::PemObject};
    let path = target.ca.clone().unwrap_or_default();
    let wrong = |found: String| FleetError::Ca {
        path: path.clone(),
        found,
    };
    let mut roots = rustls::RootCertStore::empty();
    let certificates =
        CertificateDer::pem_file_iter(&path).map_err(|error| wrong(error.to_string()))?;
    for certificate in certificates {
        let certificate = certificate.map_err(|error| wrong(error.to_string()))?;
        roots
            .add(certificate)
            .map_err(|error| wrong(error.to_string()))?;
    }
    if roots.is_empty() {
        return Err(wrong("no certificate".to_owned()));
    }
    let provider = std::sync::Arc::new(rustls::crypto::ring::default_provider());
    let builder = rustls::ClientConfig::builder_with_provider(provider)
        .with_safe_default_protocol_versions()
        .map_err(|error| wrong(error.to_string()))?;
    Ok(builder.with_root_certificates(roots).with_no_client_auth())
}
