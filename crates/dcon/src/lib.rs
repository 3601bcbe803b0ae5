//! The DCON protocol of I-7000 modules, as seen by the one master of a line. Pure: bytes in, values out.
//!
//! A request is `LEAD address command [checksum] CR`, a reply `LEAD [address] data [checksum] CR`, upper-case
//! ASCII throughout. What a reply means depends on the command that asked: `>` replies carry no address, and
//! `$AA6` is a channel mask, a level or sixteen bits, depending on the module. So the *command* decodes the reply
//! ([`Command::decode`]): by lead, exact length, grammar and range; whatever does not fit is a [`ReplyError`]
//! with its reason, never a value.
//!
//! Commands are grouped by module family, because the same letters mean different things in each:
//!
//! | family | modules | file |
//! |---|---|---|
//! | [`Common`] | all | `every_module.rs` |
//! | [`AnalogIn`] | 7017, 7017F, 7017R, 7018, 7033 | `analog_in.rs` |
//! | [`AnalogOut`] | 7021, 7021P, 7022, 7024 | `analog_out.rs` |
//! | [`Digital`] | 7041, 7043, 7045, 7050, 7051, 7060, 7063, 7065, 7067 | `digital.rs` |
//! | [`Counter`] | 7080 | `counter.rs` |
//!
//! Each family has one table: what a command does to the module ([`Nature`]) and what its reply looks like.
//!
//! Writing wears an EEPROM: whether a setting stands already is told by `standing.rs`.
//!
//! Absent by design: factory calibration and trim (`$AA0`, `$AA1`, `$AA3` of outputs, `~AAE`) cannot be written
//! down with these types, so no slip of the rig can spoil a module.

mod agreement;
mod analog_in;
mod analog_out;
mod bits;
mod bounded;
mod command;
mod config;
mod counter;
mod digital;
mod error;
mod every_module;
mod fields;
mod frame;
mod level;
mod reading;
mod reply;
mod request;
mod shape;
mod standing;
mod type_code;
mod understand;
mod words;
mod written;

#[cfg(test)]
mod tests;

pub use analog_in::{AnalogIn, InputForm};
pub use analog_out::AnalogOut;
pub use bits::{Bits, OutputWord, Width};
pub use bounded::{Address, Channel, UpTo};
pub use command::{Command, Nature};
pub use config::{BaudCode, Config, DataFormat, FormatByte, ModuleName, SlewCode};
pub use counter::{AlarmKind, AlarmState, Counter, Edge, GateMode, InputMode};
pub use digital::{Digital, GroupWrite, Stored};
pub use error::ReplyError;
pub use every_module::Common;
pub use frame::{FRAME_LIMIT, checksum};
pub use level::{Level, LevelError, OutputForm};
pub use reading::{Reading, Readings, Value};
pub use reply::{Reply, Text};
pub use type_code::{FullScale, TypeCode, Unit};
pub use understand::{Family, factory, understand};
pub use written::readings;

/// Keeps the example of the README compiling.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
