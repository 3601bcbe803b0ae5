//! Opens serial ports, with errors that name the remedy.

use super::Ports;
use std::io;
use std::path::Path;
use thiserror::Error;
use tokio_serial::{
    DataBits, ErrorKind, FlowControl, Parity, SerialPortBuilderExt, SerialStream, StopBits,
};

/// Why the line has no usable port.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum PortError {
    /// The device does not exist.
    #[error("serial port {path} does not exist")]
    Missing {
        /// Path as configured.
        path: String,
    },
    /// Another program holds the port.
    #[error("serial port {path} is taken by another program")]
    Taken {
        /// Path as configured.
        path: String,
    },
    /// The user has no permission to open the port.
    #[error("no permission to open serial port {path}")]
    Denied {
        /// Path as configured.
        path: String,
    },
    /// The device exists but is no serial port, or refuses 8N1 at this rate.
    #[error("serial port {path} cannot be used at {baud} baud: {reason}")]
    Unusable {
        /// Path as configured.
        path: String,
        /// Rate as configured, bits per second.
        baud: u32,
        /// Reason from the operating system.
        reason: String,
    },
    /// The port was open and failed.
    #[error("the port went away: {kind}")]
    Broken {
        /// Error from the operating system; `UnexpectedEof` when the other side closed the port.
        kind: io::ErrorKind,
    },
    /// A ready-made stream ended; it cannot be opened a second time.
    #[error("the stream ended and cannot be opened again")]
    Gone,
}

/// Opens `path` as 8N1 without flow control, for this program alone. Panics outside a tokio runtime with I/O.
pub fn open_serial(path: &str, baud: u32) -> Result<SerialStream, PortError> {
    tokio_serial::new(path, baud)
        .data_bits(DataBits::Eight)
        .parity(Parity::None)
        .stop_bits(StopBits::One)
        .flow_control(FlowControl::None)
        .exclusive(true)
        .open_native_async()
        .map_err(|error| port_error(path, baud, &error))
}

fn port_error(path: &str, baud: u32, error: &tokio_serial::Error) -> PortError {
    let exists = Path::new(path).exists();
    let path = path.to_owned();
    match error.kind {
        ErrorKind::Io(io::ErrorKind::PermissionDenied) => PortError::Denied { path },
        _ if !exists => PortError::Missing { path },
        // The system reports both the terminal's exclusive mode and the file lock as this.
        ErrorKind::NoDevice => PortError::Taken { path },
        ErrorKind::InvalidInput | ErrorKind::Unknown | ErrorKind::Io(_) => PortError::Unusable {
            path,
            baud,
            reason: error.description.clone(),
        },
    }
}

/// A serial port by path: opened at the first request, and again after a loss.
#[derive(Debug, Clone)]
pub struct SerialPorts {
    /// Path of the device or of a link to it.
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
