//! What (almost) every module understands: configuration, identity, host watchdog, INIT*.

use super::command::Nature::{self, Act, Read, ReadOnce, Store};
use super::request::Request;
use super::shape::Shape;
use super::{Address, Config, ModuleName, UpTo};

/// Commands common to the families.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Common {
    /// `$AA2`. A module in INIT* mode (asked at 00) answers with its stored address.
    ReadConfig,
    /// `%AANNTTCCFF`. The reply comes from the new address. Baud and checksum are refused outside INIT*.
    WriteConfig {
        /// Where the module will answer from now on.
        address: Address,
        /// Type, baud and format from now on.
        config: Config,
    },
    /// `$AA5`: true on the first read after a reset, then false. Counters have no such command.
    ReadResetStatus,
    /// `$AAF`.
    ReadFirmware,
    /// `$AAM`. The name can be rewritten: a hint, no proof of the type.
    ReadName,
    /// `~AAO(name)`.
    WriteName(ModuleName),
    /// `$AAI`: 0 when the INIT* terminal is grounded.
    ReadInitPin,
    /// `~AA0`: bit 2 set = the host watchdog has tripped; newer firmware sets bit 7 while it is enabled.
    ReadWatchdogStatus,
    /// `~AA1`: outputs obey again. The flag lives in EEPROM.
    ClearWatchdogStatus,
    /// `~AA2`.
    ReadWatchdog,
    /// `~AA3EVV`.
    WriteWatchdog {
        /// Whether a silent host trips it.
        enabled: bool,
        /// Silence that trips it, in tenths of a second, from 1.
        timeout_tenths: u8,
    },
    /// `~AARD`, newer firmware: deliberate delay before a reply, ms.
    ReadResponseDelay,
    /// `~AARDVV`, newer firmware.
    WriteResponseDelay {
        /// Delay in ms.
        delay_ms: UpTo<30>,
    },
    /// `$AAP`, newer firmware: 0 DCON, 1 Modbus RTU.
    ReadProtocol,
    /// `$AAPN`, newer firmware, within INIT*: Modbus RTU instead of DCON after the next power-on. Whoever sends it
    /// does not reach the module with DCON any more.
    WriteProtocol {
        /// False: DCON.
        modbus: bool,
    },
    /// `~AAI`: soft INIT, within the window.
    EnterSoftInit,
    /// `~AATnn`: opens the window of soft INIT.
    OpenSoftInit {
        /// Length of the window.
        seconds: UpTo<60>,
    },
}

impl Common {
    pub(super) fn encode(self, to: Address, request: &mut Request<'_>) {
        match self {
            Self::ReadConfig => request.to(b'$', to).text(b"2"),
            Self::WriteConfig { address, config } => request
                .to(b'%', to)
                .hex(u32::from(address.0), 2)
                .hex(u32::from(config.type_code.0), 2)
                .hex(u32::from(config.baud.0), 2)
                .hex(u32::from(config.format.0), 2),
            Self::ReadResetStatus => request.to(b'$', to).text(b"5"),
            Self::ReadFirmware => request.to(b'$', to).text(b"F"),
            Self::ReadName => request.to(b'$', to).text(b"M"),
            Self::WriteName(name) => request.to(b'~', to).text(b"O").text(name.as_bytes()),
            Self::ReadInitPin => request.to(b'$', to).text(b"I"),
            Self::ReadWatchdogStatus => request.to(b'~', to).text(b"0"),
            Self::ClearWatchdogStatus => request.to(b'~', to).text(b"1"),
            Self::ReadWatchdog => request.to(b'~', to).text(b"2"),
            Self::WriteWatchdog {
                enabled,
                timeout_tenths,
            } => request
                .to(b'~', to)
                .text(b"3")
                .flag(enabled)
                .hex(u32::from(timeout_tenths), 2),
            Self::ReadResponseDelay => request.to(b'~', to).text(b"RD"),
            Self::WriteResponseDelay { delay_ms } => request
                .to(b'~', to)
                .text(b"RD")
                .hex(u32::from(delay_ms.get()), 2),
            Self::ReadProtocol => request.to(b'$', to).text(b"P"),
            Self::WriteProtocol { modbus } => request.to(b'$', to).text(b"P").flag(modbus),
            Self::EnterSoftInit => request.to(b'~', to).text(b"I"),
            Self::OpenSoftInit { seconds } => request
                .to(b'~', to)
                .text(b"T")
                .hex(u32::from(seconds.get()), 2),
        };
    }

    pub(super) fn table(&self) -> (Nature, Shape) {
        match *self {
            Self::ReadConfig => (Read, Shape::Config),
            Self::WriteConfig { address, .. } => (Store, Shape::AcceptedAs(address)),
            Self::ReadResetStatus => (ReadOnce, Shape::Flag),
            Self::ReadFirmware | Self::ReadName => (Read, Shape::Text),
            Self::WriteName(_) => (Store, Shape::Accepted),
            Self::ReadInitPin => (Read, Shape::Flag),
            Self::ReadWatchdogStatus => (Read, Shape::Byte),
            Self::ClearWatchdogStatus => (Store, Shape::Accepted),
            Self::ReadWatchdog => (Read, Shape::Watchdog),
            Self::WriteWatchdog { .. } => (Store, Shape::Accepted),
            Self::ReadResponseDelay => (Read, Shape::Byte),
            Self::WriteResponseDelay { .. } => (Store, Shape::Accepted),
            Self::ReadProtocol => (Read, Shape::Flag),
            Self::WriteProtocol { .. } => (Store, Shape::Accepted),
            Self::EnterSoftInit => (Act, Shape::Accepted),
            Self::OpenSoftInit { .. } => (Act, Shape::Accepted),
        }
    }
}
