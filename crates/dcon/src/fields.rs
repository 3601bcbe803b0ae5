//! Reads the fields of a reply one after another. Each step consumes exactly the characters that the protocol
//! prescribes, or returns an error that names the missing field.

use super::frame::hex_number;
use super::{Address, ReplyError};
use std::ops::RangeInclusive;

/// Characters of a reply, and the position of the next one to read.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fields<'a> {
    text: &'a [u8],
    at: usize,
}

impl<'a> Fields<'a> {
    pub(super) fn new(text: &'a [u8]) -> Self {
        Self { text, at: 0 }
    }

    pub(super) fn at(&self) -> usize {
        self.at
    }

    pub(super) fn length(&self) -> usize {
        self.text.len()
    }

    pub(super) fn wrong_length(&self) -> ReplyError {
        ReplyError::WrongLength {
            found: self.text.len(),
        }
    }

    /// Returns the first character (the lead) without consuming it.
    pub(super) fn lead(&self) -> Option<u8> {
        self.text.first().copied()
    }

    /// Consumes the lead; checks the length of the whole reply before any field is read.
    pub(super) fn start(
        &mut self,
        expected: u8,
        lengths: RangeInclusive<usize>,
    ) -> Result<(), ReplyError> {
        match self.lead() {
            Some(found) if found == expected => self.at = 1,
            Some(found) => return Err(ReplyError::WrongLead { found, expected }),
            None => return Err(ReplyError::Empty),
        }
        if lengths.contains(&self.text.len()) {
            Ok(())
        } else {
            Err(self.wrong_length())
        }
    }

    /// Consumes the next `width` characters.
    pub(super) fn take(&mut self, width: usize) -> Result<&'a [u8], ReplyError> {
        let field = self
            .text
            .get(self.at..self.at + width)
            .ok_or(self.wrong_length())?;
        self.at += width;
        Ok(field)
    }

    /// Fails when there are characters left.
    pub(super) fn end(&self) -> Result<(), ReplyError> {
        if self.at == self.text.len() {
            Ok(())
        } else {
            Err(self.wrong_length())
        }
    }

    /// Consumes all remaining characters.
    pub(super) fn rest(&mut self) -> &'a [u8] {
        let rest = self.text.get(self.at..).unwrap_or_default();
        self.at = self.text.len();
        rest
    }

    pub(super) fn hex(&mut self, width: usize) -> Result<u32, ReplyError> {
        let at = self.at;
        hex_number(self.take(width)?).ok_or(ReplyError::BadField {
            at,
            expected: "0-9 A-F",
        })
    }

    pub(super) fn byte(&mut self) -> Result<u8, ReplyError> {
        Ok(self.hex(2)? as u8)
    }

    /// Reads decimal digits; fails on a value above `max`.
    pub(super) fn decimal(&mut self, width: usize, max: u32) -> Result<u32, ReplyError> {
        let at = self.at;
        let value = self
            .take(width)?
            .iter()
            .try_fold(0u32, |value, byte| match byte {
                b'0'..=b'9' => Ok(value * 10 + u32::from(byte - b'0')),
                _ => Err(ReplyError::BadField {
                    at,
                    expected: "0-9",
                }),
            })?;
        if value <= max {
            Ok(value)
        } else {
            Err(ReplyError::OutOfRange { at })
        }
    }

    /// Reads `0` or `1`.
    pub(super) fn flag(&mut self) -> Result<bool, ReplyError> {
        let at = self.at;
        match self.take(1)? {
            b"0" => Ok(false),
            b"1" => Ok(true),
            _ => Err(ReplyError::BadField {
                at,
                expected: "0 1",
            }),
        }
    }

    /// Consumes fixed characters that carry no information.
    pub(super) fn filler(&mut self, expected: &'static str) -> Result<(), ReplyError> {
        let at = self.at;
        if self.take(expected.len())? == expected.as_bytes() {
            Ok(())
        } else {
            Err(ReplyError::BadField { at, expected })
        }
    }

    pub(super) fn address(&mut self) -> Result<Address, ReplyError> {
        self.byte().map(Address)
    }

    /// Reads an address; fails unless it is that of the addressed module.
    pub(super) fn address_is(&mut self, expected: Address) -> Result<(), ReplyError> {
        let found = self.address()?;
        if found == expected {
            Ok(())
        } else {
            Err(ReplyError::WrongAddress { found, expected })
        }
    }
}
