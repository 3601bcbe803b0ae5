//! The port of a line, and serial ports whose errors point to the remedy.

use std::io;
use std::path::Path;
use thiserror::Error;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio_serial::{
    DataBits, ErrorKind, FlowControl, Parity, SerialPortBuilderExt, SerialStream, StopBits,
};

/// Stream of bytes to and from the modules of a line.
pub trait Port: AsyncRead + AsyncWrite + Unpin + Send {}

impl<P: AsyncRead + AsyncWrite + Unpin + Send> Port for P {}

/// Function that opens the port of a line, at the start and again after a loss.
pub type OpenPort = Box<dyn FnMut() -> Result<Box<dyn Port>, PortError> + Send>;

/// Returns a function that opens the streams of `next` one after another; it fails when `next` returns none.
pub fn from_streams<P: Port + 'static>(
    mut next: impl FnMut() -> Option<P> + Send + 'static,
) -> OpenPort {
    Box::new(move || match next() {
        Some(stream) => Ok(Box::new(stream)),
        None => Err(PortError::Gone),
    })
}

/// Reason why the line has no usable port.
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
    /// The device exists but is not a serial port, or refuses this rate with 8 data bits, no parity and 1 stop bit
    /// (8N1).
    #[error("serial port {path} cannot be used at {baud} baud: {reason}")]
    Unusable {
        /// Path as configured.
        path: String,
        /// Rate as configured, bits per second.
        baud: u32,
        /// Reason from the operating system.
        reason: String,
    },
    /// The port was open and then failed.
    #[error("the port went away: {kind}")]
    Broken {
        /// Kind of error from the operating system; `UnexpectedEof` when the other side closed the port.
        kind: io::ErrorKind,
    },
    /// A ready-made stream ended; there is no further one to open.
    #[error("the stream ended and cannot be opened again")]
    Gone,
}

/// Opens `path` exclusively: 8N1, no flow control. Panics outside a tokio runtime with I/O.
pub fn open_serial(path: &str, baud: u32) -> Result<SerialStream, PortError> {
    open_serial_with(path, baud, FlowControl::None)
}

/// Opens `path` as [`open_serial`] does, with flow control.
pub fn open_serial_with(
    path: &str,
    baud: u32,
    flow: FlowControl,
) -> Result<SerialStream, PortError> {
    tokio_serial::new(path, baud)
        .data_bits(DataBits::Eight)
        .parity(Parity::None)
        .stop_bits(StopBits::One)
        .flow_control(flow)
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
        // The system reports this kind both for the exclusive mode of a terminal and for a file lock.
        ErrorKind::NoDevice => PortError::Taken { path },
        ErrorKind::InvalidInput | ErrorKind::Unknown | ErrorKind::Io(_) => PortError::Unusable {
            path,
            baud,
            reason: error.description.clone(),
        },
    }
}

/// Returns a function that opens the serial port at `path` (a device or a link to one) at `baud` bits per second.
pub fn serial_port(path: String, baud: u32) -> OpenPort {
    Box::new(move || Ok(Box::new(open_serial(&path, baud)?)))
}
