//! Writes a request, character by character, into a reusable buffer.

use super::frame::{CR, checksum};
use super::{Address, UpTo};

/// A request being written at the end of a buffer.
pub(super) struct Request<'a> {
    out: &'a mut Vec<u8>,
    start: usize,
}

impl<'a> Request<'a> {
    pub(super) fn new(out: &'a mut Vec<u8>) -> Self {
        let start = out.len();
        Self { out, start }
    }

    /// Writes lead and address.
    pub(super) fn to(&mut self, lead: u8, address: Address) -> &mut Self {
        self.out.push(lead);
        self.hex(u32::from(address.0), 2)
    }

    pub(super) fn text(&mut self, text: &[u8]) -> &mut Self {
        self.out.extend_from_slice(text);
        self
    }

    /// Writes `digits` upper-case hex digits, most significant first.
    pub(super) fn hex(&mut self, value: u32, digits: u32) -> &mut Self {
        for place in (0..digits).rev() {
            self.out
                .push(b"0123456789ABCDEF"[(value >> (4 * place) & 0xF) as usize]);
        }
        self
    }

    /// Writes `digits` decimal digits, most significant first.
    pub(super) fn decimal(&mut self, value: u32, digits: u32) -> &mut Self {
        for place in (0..digits).rev() {
            self.out.push(b'0' + (value / 10u32.pow(place) % 10) as u8);
        }
        self
    }

    /// Writes one hex digit; writes nothing for `None`, because requests to modules with one channel name no channel.
    pub(super) fn digit<const MAX: u8>(
        &mut self,
        value: impl Into<Option<UpTo<MAX>>>,
    ) -> &mut Self {
        if let Some(value) = value.into() {
            self.hex(u32::from(value.get()), 1);
        }
        self
    }

    /// Writes `1` or `0`.
    pub(super) fn flag(&mut self, value: bool) -> &mut Self {
        self.text(if value { b"1" } else { b"0" })
    }

    /// Writes the checksum, if the line has one, and CR.
    pub(super) fn end(&mut self, with_checksum: bool) {
        if with_checksum {
            let sum = checksum(&self.out[self.start..]);
            self.hex(u32::from(sum), 2);
        }
        self.out.push(CR);
    }
}
