//! Status of an instrument: entries of its error queue, bits of its standard event register, its identity.

use super::reply::{ReplyError, beginning, string};

/// Bits of the standard event register that `*ESR?` reads and clears.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StandardEvents(pub u8);

impl StandardEvents {
    /// Returns true when the instrument was switched on since the last read, which means that its set-up is lost.
    pub const fn power_on(self) -> bool {
        self.0 & 0x80 != 0
    }
}

/// An entry of the error queue.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ErrorEntry {
    /// Error number: 0 for an empty queue, negative as defined by SCPI, positive as defined by the maker.
    pub code: i32,
    /// Text of the instrument.
    pub text: String,
}

/// Class of an error number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ErrorClass {
    /// 0: the queue is empty.
    None,
    /// -100 to -199: the instrument does not know the command.
    Command,
    /// -200 to -299: the instrument cannot carry out the command now.
    Execution,
    /// -350: the queue was full and has lost errors.
    Overflow,
    /// 550: the front panel controls the instrument (local mode).
    Local,
    /// -300 to -399 except -350, and every other positive number.
    Device,
    /// -400 to -499: a query and its reply do not fit together.
    Query,
    /// Any other negative number.
    Other,
}

impl ErrorEntry {
    /// Reads `-113,"Undefined header"`; some makers omit the quotation marks.
    ///
    /// # Errors
    /// Fails when the number or the comma is missing.
    pub fn read(line: &str) -> Result<Self, ReplyError> {
        let entry = line.split_once(',').and_then(|(code, text)| {
            let code = code.trim().parse().ok()?;
            let text = text.trim();
            let text = match text.starts_with(['"', '\'']) {
                true => string(text).ok()?,
                false => text.to_owned(),
            };
            Some(Self { code, text })
        });
        entry.ok_or_else(|| ReplyError::NotEntry {
            found: beginning(line),
        })
    }

    /// Returns the class of the number.
    pub fn class(&self) -> ErrorClass {
        match self.code {
            0 => ErrorClass::None,
            -199..=-100 => ErrorClass::Command,
            -299..=-200 => ErrorClass::Execution,
            -350 => ErrorClass::Overflow,
            550 => ErrorClass::Local,
            -399..=-300 | 1.. => ErrorClass::Device,
            -499..=-400 => ErrorClass::Query,
            ..0 => ErrorClass::Other,
        }
    }
}

/// Maker, model, serial number and firmware, as `*IDN?` returns them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Identity {
    /// Name of the maker.
    pub maker: String,
    /// Model.
    pub model: String,
    /// Serial number, or `0`.
    pub serial: String,
    /// Version of the firmware, or `0`.
    pub firmware: String,
}

impl Identity {
    /// Reads the four fields; missing ones are empty.
    pub fn read(line: &str) -> Self {
        let mut fields = line.splitn(4, ',').map(|it| it.trim().to_owned());
        let mut next = || fields.next().unwrap_or_default();
        Self {
            maker: next(),
            model: next(),
            serial: next(),
            firmware: next(),
        }
    }
}
