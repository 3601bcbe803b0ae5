//! The DCON protocol of I-7000 modules, for the one master of a line: converts commands to bytes and bytes to values,
//! and does no input or output of its own.
//!
//! A request is `LEAD address command [checksum] CR`, a reply is `LEAD [address] data [checksum] CR`, all in upper-case
//! ASCII; the lead is the first character and gives the kind of message. The meaning of a reply depends on its command:
//! `>` replies carry no address, and the reply to `$AA6` is a channel mask, a level or sixteen bits, depending on the
//! module. So the *command* decodes the reply ([`Command::decode`]) and checks lead, exact length, form and range.
//! Anything that does not fit is a [`ReplyError`] with its reason, never a value.
//!
//! ```
//! use dcon::{Address, Command, Common, Reply, ReplyError};
//!
//! let command: Command = Common::ReadResetStatus.to(Address(1));
//! let mut request = Vec::new();
//! command.encode(false, &mut request);
//! assert_eq!(request, b"$015\r");
//! assert_eq!(command.decode(b"!011\r", false), Ok(Reply::Flag(true)));
//! assert_eq!(command.decode(b"?01\r", false), Err(ReplyError::Refused));
//! ```
//!
//! # Files
//! Commands are grouped by family of modules, because the same letters mean different things in each. Each family has
//! one table: the effect of each command on the module ([`Effect`]) and the form of its reply.
//!
//! | family | modules | file |
//! |---|---|---|
//! | [`Common`] | all | `every_module.rs` |
//! | [`AnalogIn`] | 7011 to 7019, 7033 | `analog_in.rs` |
//! | [`AnalogOut`] | 7021, 7021P, 7022, 7024 | `analog_out.rs` |
//! | [`Digital`] | 7041, 7043, 7045, 7050, 7051, 7060, 7063, 7065, 7067 | `digital.rs` |
//! | [`Counter`] | 7080 | `counter.rs` |
//!
//! | file | contents |
//! |---|---|
//! | `command.rs`, `request.rs`, `frame.rs` | requests: all of them as one enum, their fields, checksum and CR |
//! | `reply.rs`, `shape.rs`, `fields.rs`, `error.rs` | replies: meanings, forms, fields, reasons why one is not accepted |
//! | `reading.rs`, `level.rs`, `bits.rs`, `bounded.rs`, `type_code.rs`, `config.rs` | values, ranges, configuration |
//! | `sensor/` | signals of Pt100 and type K at the terminals, to check a module |
//! | `setting.rs` | whether a module already has a setting, because writing wears the EEPROM |
//! | `agreement.rs` | selection of one answer among several to the same request |
//! | `decode_request.rs`, `interpret.rs` | commands that a request may be; models; meaning of an exchange |
//! | `describe.rs` | descriptions of requests, replies and errors: codes with arguments, without texts |
//!
//! # Absent by design
//! Factory calibration and trim (`$AA0`, `$AA1`, `$AA3` of outputs, `~AAE`) have no representation in these types, so
//! that no mistake of a caller can decalibrate a module.

mod agreement;
mod analog_in;
mod analog_out;
mod bits;
mod bounded;
mod command;
mod config;
mod counter;
mod decode_request;
mod describe;
mod digital;
mod error;
mod every_module;
mod fields;
mod frame;
mod interpret;
mod level;
mod reading;
mod reply;
mod request;
mod sensor;
mod setting;
mod shape;
mod type_code;

#[cfg(test)]
mod tests;

pub use analog_in::{AnalogIn, InputForm};
pub use analog_out::AnalogOut;
pub use bits::{Bits, OutputWord, Width};
pub use bounded::{Address, Channel, UpTo};
pub use command::{Command, Effect};
pub use config::{BaudCode, Config, DataFormat, FormatByte, ModuleName, SlewCode};
pub use counter::{
    AlarmKind, AlarmMode, AlarmState, Alarms, Counter, DisplayNumber, Edge, GateMode, InputMode,
};
pub use decode_request::decode_request;
pub use describe::Description;
pub use digital::{Digital, GroupWrite, Stored};
pub use error::ReplyError;
pub use every_module::Common;
pub use frame::{FRAME_LIMIT, checksum};
pub use interpret::{Family, Model, factory_command, interpret};
pub use level::{Level, LevelError, OutputForm};
pub use reading::{Reading, Readings, Value};
pub use reply::{Reply, Text};
pub use sensor::Sensor;
pub use type_code::{FullScale, TypeCode, Unit};

/// Makes `cargo test` compile the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
