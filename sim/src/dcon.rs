//! The device side of DCON: how a module parses requests and formats replies.
//!
//! A request is `LEAD AA BODY [CHK] CR`: LEAD is one of `# $ % @ ~`, AA two upper-case hexadecimal digits, CHK
//! the low byte of the sum of all characters before it. `**` in place of AA is a broadcast. A module answers
//! `!AA..` (done), `>..` (data, or output accepted), `?AA` (understood but refused) or bare `!` (output ignored,
//! the host watchdog has tripped). It does not answer an unknown request or a wrong checksum. All letters are
//! upper case; CR ends a frame, never LF.

/// Carriage return, which ends every frame in both directions.
pub const CR: u8 = b'\r';

/// Greatest length of a request or reply, characters without CR; a receiver discards longer text as line noise.
pub const LONGEST: usize = 64;

/// Addressee of a request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Address {
    /// One module.
    Module(u8),
    /// `**`: every module of the line; none of them answers.
    Everybody,
}

/// A request as a module parses it, without checksum and CR.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Request<'a> {
    /// First character, one of `# $ % @ ~`.
    pub lead: u8,
    /// Address in the two characters after the lead.
    pub address: Address,
    /// All characters after the address.
    pub body: &'a [u8],
}

/// Response of a module family to a request.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Answer {
    /// Reply text, without checksum and CR.
    Reply(String),
    /// The module understands the request and does not answer it.
    Silence,
    /// The family does not know the command.
    Unknown,
}

/// Returns the low byte of the sum of all characters.
pub fn checksum(text: &[u8]) -> u8 {
    text.iter().fold(0, |sum, byte| sum.wrapping_add(*byte))
}

/// Returns `text` without its two checksum digits; `None` when they are missing or wrong.
pub fn without_checksum(text: &[u8]) -> Option<&[u8]> {
    let split = text.len().checked_sub(2)?;
    let (body, digits) = text.split_at(split);
    (hex_byte(digits)? == checksum(body)).then_some(body)
}

/// Appends the checksum (if the module uses one) and CR.
pub fn framed(mut text: String, with_checksum: bool) -> Vec<u8> {
    if with_checksum {
        let sum = checksum(text.as_bytes());
        push_hex(&mut text, u64::from(sum), 2);
    }
    text.push('\r');
    text.into_bytes()
}

/// Parses lead and address only, before the checksum is verified.
pub fn addressee(text: &[u8]) -> Option<Address> {
    match text {
        [b'#' | b'$' | b'%' | b'@' | b'~', b'*', b'*', ..] => Some(Address::Everybody),
        [b'#' | b'$' | b'%' | b'@' | b'~', high, low, ..] => {
            hex_byte(&[*high, *low]).map(Address::Module)
        }
        _ => None,
    }
}

/// Parses a request whose checksum is already removed.
pub fn request(text: &[u8]) -> Option<Request<'_>> {
    let address = addressee(text)?;
    let (lead, body) = (*text.first()?, text.get(3..)?);
    Some(Request {
        lead,
        address,
        body,
    })
}

/// Parses two upper-case hexadecimal digits.
pub fn hex_byte(digits: &[u8]) -> Option<u8> {
    match digits {
        [_, _] => hex(digits).and_then(|value| u8::try_from(value).ok()),
        _ => None,
    }
}

/// Parses up to eight upper-case hexadecimal digits; rejects lower case.
pub fn hex(digits: &[u8]) -> Option<u32> {
    if digits.is_empty() || digits.len() > 8 {
        return None;
    }
    digits.iter().try_fold(0u32, |value, digit| {
        Some(value << 4 | u32::from(hex_digit(*digit)?))
    })
}

/// Parses one upper-case hexadecimal digit.
pub fn hex_digit(digit: u8) -> Option<u8> {
    match digit {
        b'0'..=b'9' => Some(digit - b'0'),
        b'A'..=b'F' => Some(digit - b'A' + 10),
        _ => None,
    }
}

/// Parses decimal digits without a sign.
pub fn decimal(digits: &[u8]) -> Option<u32> {
    if digits.is_empty() || digits.len() > 9 {
        return None;
    }
    digits.iter().try_fold(0u32, |value, digit| {
        digit
            .is_ascii_digit()
            .then(|| value * 10 + u32::from(digit - b'0'))
    })
}

/// Appends the low `digits` hexadecimal digits of `value`.
pub fn push_hex(text: &mut String, value: u64, digits: u32) {
    const DIGITS: &[u8; 16] = b"0123456789ABCDEF";
    for place in (0..digits).rev() {
        let nibble = (value >> (4 * place)) & 0xF;
        text.push(char::from(DIGITS[nibble as usize]));
    }
}

/// Builds `!AA`.
pub fn done(address: u8) -> Answer {
    Answer::Reply(headed('!', address))
}

/// Builds `!AA` followed by data.
pub fn done_data(address: u8, data: &str) -> Answer {
    let mut text = headed('!', address);
    text.push_str(data);
    Answer::Reply(text)
}

/// Builds `!AA` followed by `digits` hexadecimal digits.
pub fn done_hex(address: u8, value: u64, digits: u32) -> Answer {
    let mut text = headed('!', address);
    push_hex(&mut text, value, digits);
    Answer::Reply(text)
}

/// Builds `?AA`.
pub fn refused(address: u8) -> Answer {
    Answer::Reply(headed('?', address))
}

/// Builds `?`, the refusal of a digital output command.
pub fn refused_output() -> Answer {
    Answer::Reply("?".into())
}

/// Builds `>`: the module has carried out the output command.
pub fn accepted() -> Answer {
    Answer::Reply(">".into())
}

/// Builds `!`: the module ignores the output command because its host watchdog has tripped.
pub fn ignored() -> Answer {
    Answer::Reply("!".into())
}

fn headed(lead: char, address: u8) -> String {
    let mut text = String::with_capacity(LONGEST);
    text.push(lead);
    push_hex(&mut text, u64::from(address), 2);
    text
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_wrong_checksum_makes_a_request_invalid() {
        assert_eq!(without_checksum(b"$012B7"), Some(&b"$012"[..]));
        assert_eq!(without_checksum(b"$012B8"), None);
        assert_eq!(without_checksum(b"$012b7"), None);
        assert_eq!(without_checksum(b"7"), None);
    }

    #[test]
    fn replies_carry_checksum_and_carriage_return() {
        assert_eq!(framed("!01200600".into(), true), b"!01200600AA\r");
        assert_eq!(framed(">".into(), true), b">3E\r");
        assert_eq!(framed("!".into(), false), b"!\r");
    }

    #[test]
    fn lower_case_and_unknown_leads_are_no_requests() {
        assert_eq!(request(b"$0a2"), None);
        assert_eq!(request(b"!01"), None);
        assert_eq!(request(b"$0"), None);
        let all = request(b"~**").unwrap();
        assert_eq!(all.address, Address::Everybody);
    }

    #[test]
    fn numbers_are_read_by_their_digits_alone() {
        assert_eq!(decimal(b"00084"), Some(84));
        assert_eq!(decimal(b"+0084"), None);
        assert_eq!(hex(b"FFFFFFFF"), Some(u32::MAX));
        assert_eq!(hex(b"123456789"), None);
    }
}
