//! In-process streams of the simulated rig as ports of a line; they close and reopen like serial ports.

use bus::{PortError, Ports};
use rigsim::wire::Plug;
use tokio::io::DuplexStream;

/// Opens the in-process stream of one line.
pub struct WirePorts(pub Plug);

impl Ports for WirePorts {
    type Port = DuplexStream;

    async fn open(&mut self) -> Result<DuplexStream, PortError> {
        self.0.open().ok_or(PortError::Gone)
    }
}
