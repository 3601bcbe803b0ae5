//! Bits on the wire: what a receiver makes of two transmitters at once, or of a wrong baud rate.
//!
//! A character is a start bit (0), eight data bits from the lowest, and a stop bit (1); an idle wire is 1. The
//! receiver waits for a start bit, takes ten bits from there, and goes on with the next start bit. A character
//! with a broken stop bit is handed over as 0, as a terminal in raw mode does.

/// Bits of one character.
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
        // Past the end the wire is idle.
        let bit = |n: usize| bits.get(begin + n).copied().unwrap_or(true);
        let data = (0..8).fold(0u8, |byte, n| byte | u8::from(bit(n + 1)) << n);
        characters.push(if bit(9) { data } else { 0 });
        at = begin + CHARACTER;
    }
    characters
}

/// Two transmitters, the second `apart` bits after the first (before it when negative): a 0 of either wins.
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

/// What a receiver hears of a transmitter that sends `times` as slowly as it listens.
pub(crate) fn heard_faster(bytes: &[u8], times: usize) -> Vec<u8> {
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
    fn what_one_transmitter_sends_is_heard() {
        let every: Vec<u8> = (0..=255).collect();
        assert_eq!(characters_of(&bits_of(&every)), every);
        assert_eq!(superposed(&every, &[], 7), every);
        assert_eq!(heard_faster(&every, 1), every);
    }

    #[test]
    fn two_transmitters_in_step_leave_the_zeros_of_both() {
        assert_eq!(superposed(b">12\r", b">34\r", 0), [b'>', b'1', b'0', b'\r']);
        assert_eq!(superposed(b"!01", b"!01", 0), b"!01");
    }

    #[test]
    fn transmitters_that_do_not_overlap_are_heard_one_after_the_other() {
        assert_eq!(superposed(b">1\r", b">2\r", 30), b">1\r>2\r");
        assert_eq!(superposed(b">1\r", b">2\r", -31), b">2\r>1\r");
    }

    #[test]
    fn half_a_character_apart_nothing_is_left_of_either() {
        let heard = superposed(b">7FFF47\r", b">800006\r", 5);
        assert!(!heard.windows(2).any(|pair| pair == b">7" || pair == b">8"));
    }

    #[test]
    fn a_slower_transmitter_is_heard_as_other_and_more_characters() {
        let heard = heard_faster(b">+05.123\r", 2);
        assert!(heard.len() > 9 && !heard.contains(&b'>'));
    }
}
