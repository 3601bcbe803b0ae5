//! Where an instrument is: `tcp:HOST:PORT`, `serial:PATH:BAUD`, and either behind a GPIB adapter.

use serde::Deserialize;
use std::fmt;
use std::str::FromStr;
use thiserror::Error;

/// Way to an instrument.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LinkAddress {
    /// The stream.
    pub transport: Transport,
    /// GPIB address, 0 to 30, behind a Prologix-type adapter; `None` without one.
    pub gpib: Option<u8>,
}

/// Stream of bytes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Transport {
    /// Network connection.
    Tcp {
        /// Name or address of the host.
        host: String,
        /// Port.
        port: u16,
    },
    /// Serial port, 8N1.
    Serial {
        /// Path of the device.
        path: String,
        /// Bits per second.
        baud: u32,
    },
}

/// Flow control of a serial port.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Flow {
    /// None.
    #[default]
    None,
    /// XON and XOFF characters.
    Xon,
    /// RTS and CTS lines.
    Rts,
}

/// Why a text is no address of an instrument.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("found \"{found}\", expected {}", LinkAddress::FORMS)]
pub struct LinkAddressError {
    /// The text.
    pub found: String,
}

impl LinkAddress {
    /// Forms of an address in words.
    pub const FORMS: &str =
        "tcp:HOST:PORT, serial:PATH:BAUD, gpib-tcp:HOST:PORT:ADDR or gpib-serial:PATH:BAUD:ADDR";

    /// Returns the place of the stream, without its kind and without a GPIB address: `HOST:PORT` or `PATH:BAUD`.
    pub fn place(&self) -> String {
        match &self.transport {
            Transport::Tcp { host, port } => format!("{host}:{port}"),
            Transport::Serial { path, baud } => format!("{path}:{baud}"),
        }
    }
}

impl FromStr for LinkAddress {
    type Err = LinkAddressError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        read(text).ok_or_else(|| LinkAddressError {
            found: text.to_owned(),
        })
    }
}

fn read(text: &str) -> Option<LinkAddress> {
    let (kind, rest) = text.split_once(':')?;
    let (rest, gpib) = match kind.starts_with("gpib-") {
        true => {
            let (rest, address) = rest.rsplit_once(':')?;
            let address = address.parse().ok().filter(|it| *it <= 30)?;
            (rest, Some(address))
        }
        false => (rest, None),
    };
    let (place, number) = rest.rsplit_once(':')?;
    let place = Some(place).filter(|it| !it.is_empty())?.to_owned();
    let transport = match kind {
        "tcp" | "gpib-tcp" => {
            let port = number.parse().ok().filter(|it| *it > 0)?;
            Transport::Tcp { host: place, port }
        }
        "serial" | "gpib-serial" => {
            let baud = number.parse().ok().filter(|it| *it > 0)?;
            Transport::Serial { path: place, baud }
        }
        _ => return None,
    };
    Some(LinkAddress { transport, gpib })
}

impl fmt::Display for LinkAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let adapter = if self.gpib.is_some() { "gpib-" } else { "" };
        match &self.transport {
            Transport::Tcp { host, port } => write!(f, "{adapter}tcp:{host}:{port}")?,
            Transport::Serial { path, baud } => write!(f, "{adapter}serial:{path}:{baud}")?,
        }
        self.gpib.map_or(Ok(()), |it| write!(f, ":{it}"))
    }
}
