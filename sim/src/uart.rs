//! Bits on the wire: characters that a receiver gets from two transmitters at once, or at a wrong baud rate.
//!
//! A character is a start bit (0), eight data bits from the lowest, and a stop bit (1); an idle wire is 1. The receiver
//! waits for a start bit, samples ten bits, and waits for the next start bit. It reads a character whose stop bit is 0
//! as the byte 0, as a terminal in raw mode does.

/// Number of bits in a character.
const CHARACTER: usize = 10;

fn bits_of(bytes: &[u8]) -> Vec<bool> {
    let character = |byte: &u8| {
        let data = u16::from(*byte) << 1 | 1 << 9;
        (0..CHARACTER).map(move |bit| data & 1 << bit != 0)
    };
    bytes.iter().flat_map(character).collect()
}

fn characters_of(bits: &[bool]) -> Vec<u8> {
    let mut characters = Vec::new();
    let mut at = 0;
    while let Some(start) = bits[at.min(bits.len())..].iter().position(|bit| !bit) {
        let begin = at.min(bits.len()) + start;
        // The wire is idle past the end.
        let bit = |n: usize| bits.get(begin + n).copied().unwrap_or(true);
        let data = (0..8).fold(0u8, |byte, n| byte | u8::from(bit(n + 1)) << n);
        characters.push(if bit(9) { data } else { 0 });
        at = begin + CHARACTER;
    }
    characters
}

/// Superposes two transmitters, the second `apart` bits after the first (before it when negative); a 0 wins.
pub(crate) fn superposed(first: &[u8], second: &[u8], apart: i64) -> Vec<u8> {
    let pad = |bytes: &[u8], before: i64| {
        let idle = usize::try_from(before).unwrap_or(0);
        let mut bits = vec![true; idle];
        bits.extend(bits_of(bytes));
        bits
    };
    let (first, second) = (pad(first, -apart), pad(second, apart));
    let bit = |bits: &[bool], n: usize| bits.get(n).copied().unwrap_or(true);
    let both: Vec<bool> = (0..first.len().max(second.len()))
        .map(|n| bit(&first, n) && bit(&second, n))
        .collect();
    characters_of(&both)
}

/// Returns the characters that a receiver gets when its rate is `times` that of the transmitter.
pub(crate) fn sampled_too_fast(bytes: &[u8], times: usize) -> Vec<u8> {
    let sent = bits_of(bytes);
    let slow: Vec<bool> = sent
        .into_iter()
        .flat_map(|bit| std::iter::repeat_n(bit, times))
        .collect();
    characters_of(&slow)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_transmitter_is_received_unchanged() {
        let every: Vec<u8> = (0..=255).collect();
        assert_eq!(characters_of(&bits_of(&every)), every);
        assert_eq!(superposed(&every, &[], 7), every);
        assert_eq!(sampled_too_fast(&every, 1), every);
    }

    #[test]
    fn synchronous_transmitters_merge_their_zeros() {
        assert_eq!(superposed(b">12\r", b">34\r", 0), [b'>', b'1', b'0', b'\r']);
        assert_eq!(superposed(b"!01", b"!01", 0), b"!01");
    }

    #[test]
    fn transmitters_without_overlap_arrive_in_sequence() {
        assert_eq!(superposed(b">1\r", b">2\r", 30), b">1\r>2\r");
        assert_eq!(superposed(b">1\r", b">2\r", -31), b">2\r>1\r");
    }

    #[test]
    fn half_a_character_apart_destroys_both_replies() {
        let heard = superposed(b">7FFF47\r", b">800006\r", 5);
        assert!(!heard.windows(2).any(|pair| pair == b">7" || pair == b">8"));
    }

    #[test]
    fn a_slower_transmitter_gives_more_and_other_characters() {
        let heard = sampled_too_fast(b">+05.123\r", 2);
        assert!(heard.len() > 9 && !heard.contains(&b'>'));
    }
}
