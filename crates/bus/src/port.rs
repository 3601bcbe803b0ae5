//! Opening serial ports, with errors that say what to do.

use super::Ports;
use std::io;
use std::path::Path;
use thiserror::Error;
use tokio_serial::{
    DataBits, ErrorKind, FlowControl, Parity, SerialPortBuilderExt, SerialStream, StopBits,
};

/// Why there is no port to talk through.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum PortError {
    /// No such device.
    #[error("serial port {path} does not exist")]
    Missing {
        /// As configured.
        path: String,
    },
    /// Another program holds it.
    #[error("serial port {path} is taken by another program")]
    Taken {
        /// As configured.
        path: String,
    },
    /// The user may not open it.
    #[error("no permission to open serial port {path}")]
    Denied {
        /// As configured.
        path: String,
    },
    /// It is there but is no serial port, or refuses 8N1 at this rate.
    #[error("serial port {path} cannot be used at {baud} baud: {reason}")]
    Unusable {
        /// As configured.
        path: String,
        /// As configured.
        baud: u32,
        /// As the system says.
        reason: String,
    },
    /// It was open, and ended.
    #[error("the port went away: {kind}")]
    Broken {
        /// As the system says; unexpected end when the other side closed it.
        kind: io::ErrorKind,
    },
    /// A stream that was handed over ready-made cannot be opened a second time.
    #[error("the stream ended and cannot be opened again")]
    Gone,
}

/// Opens `path` as 8N1 without flow control, for this program alone. Must run inside a tokio runtime with I/O.
pub fn open_serial(path: &str, baud: u32) -> Result<SerialStream, PortError> {
    tokio_serial::new(path, baud)
        .data_bits(DataBits::Eight)
        .parity(Parity::None)
        .stop_bits(StopBits::One)
        .flow_control(FlowControl::None)
        .exclusive(true)
        .open_native_async()
        .map_err(|error| told(path, baud, &error))
}

fn told(path: &str, baud: u32, error: &tokio_serial::Error) -> PortError {
    let exists = Path::new(path).exists();
    let path = path.to_owned();
    match error.kind {
        ErrorKind::Io(io::ErrorKind::PermissionDenied) => PortError::Denied { path },
        _ if !exists => PortError::Missing { path },
        // Both the terminal's exclusive mode and the file lock are reported as this.
        ErrorKind::NoDevice => PortError::Taken { path },
        ErrorKind::InvalidInput | ErrorKind::Unknown | ErrorKind::Io(_) => PortError::Unusable {
            path,
            baud,
            reason: error.description.clone(),
        },
    }
}

/// A serial port by path: opened at the first request, and again after it was lost.
#[derive(Debug, Clone)]
pub struct SerialPorts {
    /// Device, or a link to it.
    pub path: String,
    /// Bits per second.
    pub baud: u32,
}

impl Ports for SerialPorts {
    type Port = SerialStream;

    async fn open(&mut self) -> Result<SerialStream, PortError> {
        open_serial(&self.path, self.baud)
    }
}
