//! Commands of every module type, with few exceptions: configuration, identity, host watchdog, INIT*.

use super::command::Effect::{self, Act, Read, ReadOnce, Store};
use super::request::Request;
use super::shape::Shape;
use super::{Address, Config, ModuleName, UpTo};

/// Commands common to all families.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Common {
    /// `$AA2`: reads the configuration. A module in INIT* mode (addressed as 00) answers with its stored address.
    ReadConfig,
    /// `%AANNTTCCFF`: writes the configuration. The reply comes from the new address. Outside INIT* the module refuses
    /// to change baud rate and checksum.
    WriteConfig {
        /// New address of the module.
        address: Address,
        /// New type, baud and format.
        config: Config,
    },
    /// `$AA5`: reads the reset status, which is true at the first read after a reset, then false. Counter modules lack
    /// this command.
    ReadResetStatus,
    /// `$AAF`: reads the firmware version.
    ReadFirmware,
    /// `$AAM`: reads the module name. The name can be rewritten, so it does not prove the type of the module.
    ReadName,
    /// `~AAO(name)`: sets the module name.
    WriteName(ModuleName),
    /// `$AAI`: reads the INIT* terminal: 0 when it is grounded.
    ReadInitPin,
    /// `~AA0`: reads the status of the host watchdog. Bit 2: it has tripped. Bit 7, in newer firmware: it is enabled.
    ReadWatchdogStatus,
    /// `~AA1`: clears the status of a tripped watchdog, so that the host can write outputs again. The module keeps this
    /// status in EEPROM.
    ClearWatchdogStatus,
    /// `~AA2`: reads the settings of the host watchdog.
    ReadWatchdog,
    /// `~AA3EVV`: sets the host watchdog.
    WriteWatchdog {
        /// True switches the watchdog on.
        enabled: bool,
        /// Time without a message from the host after which the watchdog trips, tenths of a second, from 1.
        timeout_tenths: u8,
    },
    /// `~AARD`, newer firmware: reads the configured delay before a reply, ms.
    ReadResponseDelay,
    /// `~AARDVV`, newer firmware: sets the delay before a reply.
    WriteResponseDelay {
        /// Delay, ms.
        delay_ms: UpTo<30>,
    },
    /// `$AAP`, newer firmware: reads the protocol: 0 DCON, 1 Modbus RTU.
    ReadProtocol,
    /// `$AAPN`, newer firmware, in INIT* mode only: selects the protocol from the next power-on. A module set to Modbus
    /// RTU no longer answers to DCON.
    WriteProtocol {
        /// True for Modbus RTU, false for DCON.
        modbus: bool,
    },
    /// `~AAI`: begins soft INIT: for the seconds that [`Common::OpenSoftInit`] has set, `%AANNTTCCFF` may change baud
    /// rate and checksum without a wire on INIT*.
    EnterSoftInit,
    /// `~AATnn`: sets for how long soft INIT lasts after [`Common::EnterSoftInit`].
    OpenSoftInit {
        /// Duration, seconds; 0, the value at power-on, does not permit soft INIT.
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

    pub(super) fn table(&self) -> (Effect, Shape) {
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
