//! A program without TLS: it has no certificate and refuses to read one.

use super::listener::ListenError;
use std::path::Path;
use tokio::net::TcpStream;

/// A certificate, of which this program has none.
#[derive(Debug, Clone)]
pub enum Tls {}

impl Tls {
    /// Refuses the certificate.
    ///
    /// # Errors
    /// Fails always: this program has no TLS.
    pub const fn load(_cert: &Path, _key: &Path) -> Result<Self, ListenError> {
        Err(ListenError::NoTls)
    }

    /// Never runs, because there is no certificate.
    pub(super) async fn accept(&self, _stream: TcpStream) -> std::io::Result<TcpStream> {
        match *self {}
    }
}
