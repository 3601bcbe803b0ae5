//! Cuts a stream of bytes into replies: lines, and blocks by their length.

use super::reply::{BLOCK_LIMIT, Form, LINE_LIMIT, Raw, ReplyError};

/// Bytes of one reply as they arrive; the form of the reply bounds their number.
#[derive(Debug, Default)]
pub struct Reader {
    bytes: Vec<u8>,
    /// The complete reply, while the line that must follow it is still missing.
    found: Option<Raw>,
}

impl Reader {
    /// Discards all bytes; returns how many there were.
    pub fn clear(&mut self) -> usize {
        let forgotten = self.bytes.len();
        self.bytes.clear();
        self.found = None;
        forgotten
    }

    /// Returns the number of bytes that belong to no complete reply yet.
    pub fn waiting(&self) -> usize {
        self.bytes.len()
    }

    /// Returns the complete reply that still waits for the line that must follow it.
    pub fn without_tail(&self) -> Option<&Raw> {
        self.found.as_ref()
    }

    /// Adds bytes of a reply in `form`.
    ///
    /// # Errors
    /// Fails as soon as the bytes cannot become such a reply.
    pub fn push(&mut self, bytes: &[u8], form: Form) -> Result<(), ReplyError> {
        self.bytes.extend_from_slice(bytes);
        // After a complete reply only a line may follow.
        let form = if self.found.is_some() {
            Form::Line
        } else {
            form
        };
        let header = self.header(form)?;
        let (length, most) = match header {
            Some(_) => (0, 0),
            None => (self.first_line().unwrap_or(self.bytes.len()), LINE_LIMIT),
        };
        if length > most {
            return Err(ReplyError::TooLong { length, most });
        }
        Ok(())
    }

    /// Removes and returns the next complete reply; `None` while bytes are missing.
    ///
    /// # Errors
    /// Fails when a block has a wrong header or is not followed by its end.
    pub fn take(&mut self, form: Form) -> Result<Option<Raw>, ReplyError> {
        match self.header(form)? {
            Some(Header::Partial) => Ok(None),
            Some(Header::Whole { start, length }) => self.block(start, length),
            None => Ok(self.line().map(Raw::Line)),
        }
    }

    /// Removes and returns a reply together with the line `tail` that must follow it; `None` while bytes are missing.
    /// The inner error holds the line that came instead of `tail`.
    ///
    /// # Errors
    /// Fails as [`Reader::take`] does.
    pub fn take_with_tail(
        &mut self,
        form: Form,
        tail: Option<&str>,
    ) -> Result<Option<Result<Raw, Vec<u8>>>, ReplyError> {
        if self.found.is_none() {
            self.found = self.take(form)?;
        }
        let Some(tail) = tail else {
            return Ok(self.found.take().map(Ok));
        };
        if self.found.is_none() {
            return Ok(None);
        }
        let Some(line) = self.line() else {
            return Ok(None);
        };
        let is_tail = line.trim_ascii() == tail.as_bytes();
        let found = self.found.take().filter(|_| is_tail);
        Ok(Some(found.ok_or(line)))
    }

    fn first_line(&self) -> Option<usize> {
        self.bytes.iter().position(|it| *it == b'\n')
    }

    fn line(&mut self) -> Option<Vec<u8>> {
        let end = self.first_line()?;
        let mut line: Vec<u8> = self.bytes.drain(..=end).collect();
        line.pop();
        while line.last() == Some(&b'\r') {
            line.pop();
        }
        // XON and XOFF from a serial port whose driver does not remove them.
        line.retain(|it| !matches!(it, 0x11 | 0x13));
        Some(line)
    }

    fn block(&mut self, start: usize, length: usize) -> Result<Option<Raw>, ReplyError> {
        let end = start + length;
        // Some instruments end with CR LF.
        let rest = self.bytes.get(end..).unwrap_or_default();
        let behind = match rest {
            [b'\n', ..] => 1,
            [b'\r', b'\n', ..] => 2,
            [] | [b'\r'] => return Ok(None),
            [byte, ..] => return Err(ReplyError::BlockEnd { byte: *byte }),
        };
        let bytes: Vec<u8> = self.bytes.drain(..end + behind).collect();
        let payload = bytes.get(start..end).unwrap_or_default();
        Ok(Some(Raw::Block(payload.to_vec())))
    }

    /// Returns the header of a block; `None` when the reply is a line.
    fn header(&self, form: Form) -> Result<Option<Header>, ReplyError> {
        let most = match form {
            Form::Block(most) => most.min(BLOCK_LIMIT),
            Form::Any => BLOCK_LIMIT,
            Form::Line | Form::Number | Form::Numbers | Form::Text => return Ok(None),
        };
        let is_digits = |it: &[u8]| it.iter().all(u8::is_ascii_digit);
        let (count, digits) = match self.bytes.as_slice() {
            [] | [b'#'] => return Ok(Some(Header::Partial)),
            [b'#', count @ b'1'..=b'9', digits @ ..] => (usize::from(count - b'0'), digits),
            [b'#', b'0', ..] => return Err(ReplyError::BlockHeader),
            // The reply may also be a number such as `#H1F`.
            [_, ..] if form == Form::Any => return Ok(None),
            [_, ..] => return Err(ReplyError::BlockHeader),
        };
        let digits = &digits[..count.min(digits.len())];
        if !is_digits(digits) {
            return Err(ReplyError::BlockHeader);
        }
        if digits.len() < count {
            return Ok(Some(Header::Partial));
        }
        let length = digits
            .iter()
            .fold(0, |sum, it| sum * 10 + usize::from(it - b'0'));
        match length {
            0 => Err(ReplyError::Empty),
            _ if length > most => Err(ReplyError::TooLong { length, most }),
            _ => Ok(Some(Header::Whole {
                start: 2 + count,
                length,
            })),
        }
    }
}

enum Header {
    /// Digits of the header are missing.
    Partial,
    /// Position of the first byte of content, and number of bytes.
    Whole { start: usize, length: usize },
}
