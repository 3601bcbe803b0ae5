//! Framing: printable characters, checksum, CR.

use super::ReplyError;

/// Greatest accepted length of a frame, characters, CR included. The longest reply of the protocol has 60.
pub const FRAME_LIMIT: usize = 64;

/// Carriage return: the only character that ends a frame.
pub(super) const CR: u8 = 0x0D;

/// Returns the checksum: the sum of all characters from the lead on, modulo 256.
pub fn checksum(text: &[u8]) -> u8 {
    text.iter().fold(0, |sum: u8, byte| sum.wrapping_add(*byte))
}

/// Removes checksum and CR. Returns the characters before them, and whether CR or checksum proves the frame complete.
pub(super) fn open(frame: &[u8], with_checksum: bool) -> Result<(&[u8], bool), ReplyError> {
    if frame.len() > FRAME_LIMIT {
        return Err(ReplyError::TooLong {
            length: frame.len(),
        });
    }
    let (text, ended) = match frame.split_last() {
        None => return Err(ReplyError::Empty),
        Some((&CR, text)) => (text, true),
        Some(_) => (frame, false),
    };
    if let Some(at) = text.iter().position(|byte| !(0x20..0x7F).contains(byte)) {
        return Err(ReplyError::NotText { at, byte: text[at] });
    }
    let text = if with_checksum { verified(text)? } else { text };
    if text.is_empty() {
        return Err(ReplyError::Empty);
    }
    // A correct checksum proves the end of the frame as well as a CR does.
    Ok((text, ended || with_checksum))
}

fn verified(text: &[u8]) -> Result<&[u8], ReplyError> {
    let split = text.split_last_chunk::<2>();
    let Some((text, found)) = split.and_then(|(text, sum)| Some((text, hex_number(sum)? as u8)))
    else {
        return Err(ReplyError::ChecksumMissing);
    };
    let expected = checksum(text);
    if found == expected {
        Ok(text)
    } else {
        Err(ReplyError::ChecksumWrong { found, expected })
    }
}

/// Returns the value of one to eight upper-case hex digits; `None` for anything else.
pub(super) fn hex_number(text: &[u8]) -> Option<u32> {
    if text.is_empty() || text.len() > 8 {
        return None;
    }
    text.iter().try_fold(0u32, |value, byte| {
        Some(value << 4 | u32::from(hex_digit(*byte)?))
    })
}

/// Returns the value of an upper-case hex digit; `None` for any other byte, lower-case digits included.
pub(super) fn hex_digit(byte: u8) -> Option<u8> {
    match byte {
        b'0'..=b'9' => Some(byte - b'0'),
        b'A'..=b'F' => Some(byte - b'A' + 10),
        _ => None,
    }
}
