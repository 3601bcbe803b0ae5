//! Opens the socket where the page listens.

use super::tls::Tls;
use std::net::{SocketAddr, TcpListener};
#[cfg(feature = "tls")]
use std::path::PathBuf;

/// Reason why the page cannot listen at an address.
#[derive(Debug, thiserror::Error)]
pub enum ListenError {
    /// Other computers can reach the address, but there is no certificate, so passwords would travel unencrypted.
    #[error(
        "--listen {0}: found an address that other computers reach, expected --tls-cert and --tls-key with it, or \
         127.0.0.1 behind a proxy"
    )]
    InTheClear(SocketAddr),
    /// This program has no TLS.
    #[cfg(not(feature = "tls"))]
    #[error(
        "--tls-cert: found a program without TLS, expected one that was built with `--features tls`, as that of the \
         Debian package is"
    )]
    NoTls,
    /// The file of the certificate or of the key cannot be read as PEM, or holds no certificate or no key.
    #[cfg(feature = "tls")]
    #[error("{path}: expected {expected} as PEM: {source}")]
    Pem {
        /// The file.
        path: PathBuf,
        /// What the file should hold.
        expected: &'static str,
        /// Error of the reader.
        source: tokio_rustls::rustls::pki_types::pem::Error,
    },
    /// The key does not belong to the certificate, or the kind of key is unknown.
    #[cfg(feature = "tls")]
    #[error("{cert} and {key}: {source}")]
    Pair {
        /// File of the certificate.
        cert: PathBuf,
        /// File of the key.
        key: PathBuf,
        /// Error of the TLS library.
        source: tokio_rustls::rustls::Error,
    },
    /// The address is in use, or does not belong to this computer.
    #[error("--listen {listen}: the page cannot listen there")]
    Bind {
        /// The address.
        listen: SocketAddr,
        /// Error of the system.
        source: std::io::Error,
    },
}

/// A socket where the page listens.
#[derive(Debug)]
pub struct Listener {
    socket: TcpListener,
    tls: Option<Tls>,
}

impl Listener {
    /// Listens at an address, over TLS when `tls` has a certificate.
    ///
    /// # Errors
    /// Fails when other computers can reach the address but there is no certificate, and when the address is in use or
    /// does not belong to this computer.
    pub fn open(listen: SocketAddr, tls: Option<Tls>) -> Result<Self, ListenError> {
        if tls.is_none() && !listen.ip().to_canonical().is_loopback() {
            return Err(ListenError::InTheClear(listen));
        }
        match TcpListener::bind(listen) {
            Ok(socket) => Ok(Self { socket, tls }),
            Err(source) => Err(ListenError::Bind { listen, source }),
        }
    }

    /// Returns the socket, and the certificate if there is one.
    #[must_use]
    pub fn into_parts(self) -> (TcpListener, Option<Tls>) {
        (self.socket, self.tls)
    }
}
