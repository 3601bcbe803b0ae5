//! One serial line as its modules see it: timing of characters, and framing of requests.
//!
//! The host writes several bytes at once; on the wire each takes ten bits. A request arrives with its CR. The receiver
//! joins fragments, separates several requests in one piece, discards a partial request after [`SILENCE_US`] without a
//! character, and discards an overlong request up to its CR.

use crate::dcon;

/// Silence after which the receiver discards a partial request as the remains of a crashed client, microseconds.
pub const SILENCE_US: u64 = 150_000;

/// Bits of a character: start, eight data, stop.
const BITS: u64 = 10;

/// Returns the time of `characters` on the wire, microseconds, rounded up.
pub fn wire_us(characters: usize, baud: u32) -> u64 {
    (characters as u64 * BITS * 1_000_000).div_ceil(u64::from(baud.max(1)))
}

/// A request and the instant at which its CR arrives.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Arrival {
    /// Rig time, microseconds.
    pub at_us: u64,
    /// Request without CR.
    pub text: Vec<u8>,
}

/// Receiver of a line; assembles bytes into requests.
#[derive(Debug, Clone)]
pub struct Receiver {
    baud: u32,
    partial: Vec<u8>,
    too_long: bool,
    /// Instant until which earlier characters occupy the wire.
    busy_until_us: u64,
}

impl Receiver {
    /// Creates a receiver without pending characters.
    pub fn new(baud: u32) -> Self {
        Self {
            baud,
            partial: Vec::with_capacity(dcon::LONGEST),
            too_long: false,
            busy_until_us: 0,
        }
    }

    /// Changes the host's baud rate for the bytes that follow.
    pub fn retune(&mut self, baud: u32) {
        self.baud = baud;
    }

    /// Accepts bytes that the host sends at `now_us`; returns the requests that they complete, without overlong ones.
    pub fn take(&mut self, bytes: &[u8], now_us: u64) -> Vec<Arrival> {
        if now_us > self.busy_until_us + SILENCE_US {
            self.partial.clear();
            self.too_long = false;
        }
        let begin_us = now_us.max(self.busy_until_us);
        let mut arrivals = Vec::new();
        for (place, byte) in bytes.iter().enumerate() {
            if *byte == dcon::CR {
                let text = std::mem::take(&mut self.partial);
                if !std::mem::take(&mut self.too_long) {
                    let at_us = begin_us + wire_us(place + 1, self.baud);
                    arrivals.push(Arrival { at_us, text });
                }
            } else if self.partial.len() < dcon::LONGEST {
                self.partial.push(*byte);
            } else {
                self.too_long = true;
            }
        }
        self.busy_until_us = begin_us + wire_us(bytes.len(), self.baud);
        arrivals
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(arrivals: &[Arrival]) -> Vec<&[u8]> {
        arrivals.iter().map(|arrival| &arrival.text[..]).collect()
    }

    #[test]
    fn a_request_arrives_with_its_last_character() {
        let mut line = Receiver::new(9_600);
        let arrivals = line.take(b"#01\r", 1_000);
        assert_eq!(arrivals[0].at_us, 1_000 + 4_167);
    }

    #[test]
    fn fragments_join_and_joined_requests_separate() {
        let mut line = Receiver::new(115_200);
        assert!(line.take(b"#0", 0).is_empty());
        let arrivals = line.take(b"1\r$012\r", 50_000);
        assert_eq!(texts(&arrivals), [&b"#01"[..], &b"$012"[..]]);
        assert!(arrivals[0].at_us < arrivals[1].at_us);
    }

    #[test]
    fn a_partial_request_is_discarded_after_silence() {
        let mut line = Receiver::new(115_200);
        assert!(line.take(b"#0", 0).is_empty());
        let arrivals = line.take(b"$012\r", 200_000);
        assert_eq!(texts(&arrivals), [&b"$012"[..]]);
    }

    #[test]
    fn an_overlong_request_is_dropped_up_to_its_end() {
        let mut line = Receiver::new(115_200);
        assert!(line.take(&[b'x'; 500], 0).is_empty());
        assert_eq!(texts(&line.take(b"\r#01\r", 50_000)), [&b"#01"[..]]);
    }
}
