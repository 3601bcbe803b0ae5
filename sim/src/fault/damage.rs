//! Altered replies: flipped bits, foreign bytes, the host's own echo, a second transmitter, a wrong baud rate.
//!
//! Second transmitters and wrong baud rates act on the bits of the wire ([`crate::uart`]), so that the host
//! receives what a real receiver would: shifted characters and broken stop bits.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::value::{Chances, FaultRequest, Targets, Trigger};
use super::{Family, FaultEntry};
use crate::dcon;
use crate::error::SimError;
use crate::uart;

const LIST: [FaultEntry; 5] = [
    FaultEntry {
        name: "flip",
        unit: "probability",
        default: "0.01",
        what: "one bit of a reply is flipped",
    },
    FaultEntry {
        name: "noise",
        unit: "probability",
        default: "0.01",
        what: "one to four random bytes before a reply",
    },
    FaultEntry {
        name: "echo",
        unit: "probability",
        default: "1",
        what: "the request comes back before the reply",
    },
    FaultEntry {
        name: "clash",
        unit: "MODULE[@s] or probability",
        default: "board_di",
        what: "a second module of the kind answers at the same address",
    },
    FaultEntry {
        name: "garble",
        unit: "probability",
        default: "0.01",
        what: "a reply is sent at half or a third of the baud rate",
    },
];

/// Greatest offset between the simultaneous replies of two modules at one address, bits: two characters.
const APART_BITS: i64 = 20;

#[derive(Default)]
pub(super) struct Damage {
    flip: Chances,
    noise: Chances,
    echo: Chances,
    garble: Chances,
    clash: Chances,
    clashing: Targets,
}

impl Family for Damage {
    fn list(&self) -> &'static [FaultEntry] {
        &LIST
    }

    fn add(&mut self, request: &FaultRequest<'_>) -> Result<(), SimError> {
        let chances = match request.name {
            "flip" => &mut self.flip,
            "noise" => &mut self.noise,
            "echo" => &mut self.echo,
            "garble" => &mut self.garble,
            "clash" => match request.trigger()? {
                Trigger::Chance(..) => &mut self.clash,
                Trigger::Target(module) => {
                    self.clashing.add(module, request.window);
                    return Ok(());
                }
            },
            name => unreachable!("fault `{name}` is listed without a branch here"),
        };
        chances.add(request.probability()?, request.window);
        Ok(())
    }

    fn targets(&self) -> Vec<&str> {
        self.clashing.names().collect()
    }
}

impl Damage {
    /// When the fault strikes, superposes on the reply of `module` that of a second module at the same address.
    pub(super) fn clash(
        &self,
        module: &str,
        reply: &mut Vec<u8>,
        rng: &mut ChaCha8Rng,
        now_us: u64,
    ) {
        if self.clashing.hold(module, now_us) || self.clash.occurs(rng, now_us) {
            let twin = twin(reply, rng);
            let apart = rng.random_range(-APART_BITS..=APART_BITS);
            *reply = uart::superposed(reply, &twin, apart);
        }
    }

    /// Damages a reply on its way to the host.
    pub(super) fn apply(
        &self,
        request: &[u8],
        reply: &mut Vec<u8>,
        rng: &mut ChaCha8Rng,
        now_us: u64,
    ) {
        if self.flip.occurs(rng, now_us) && !reply.is_empty() {
            let bit = rng.random_range(0..reply.len() * 8);
            reply[bit / 8] ^= 1 << (bit % 8);
        }
        if self.garble.occurs(rng, now_us) {
            *reply = uart::sampled_too_fast(reply, rng.random_range(2..=3));
        }
        if self.noise.occurs(rng, now_us) {
            let count = rng.random_range(1..=4);
            let noise: Vec<u8> = (0..count).map(|_| rng.random()).collect();
            reply.splice(0..0, noise);
        }
        if self.echo.occurs(rng, now_us) && !request.is_empty() {
            reply.splice(0..0, request.iter().copied().chain([dcon::CR]));
        }
    }
}

/// Returns the reply of another module of the same kind and address: other digits, and a valid checksum if `reply`
/// has one.
fn twin(reply: &[u8], rng: &mut ChaCha8Rng) -> Vec<u8> {
    let text = reply.strip_suffix(&[dcon::CR]).unwrap_or(reply);
    let bare = dcon::without_checksum(text);
    let mut other: String = String::new();
    for byte in bare.unwrap_or(text) {
        other.push(match byte {
            b'0'..=b'9' | b'A'..=b'F' => char::from(b"0123456789"[rng.random_range(0..10)]),
            _ => char::from(*byte),
        });
    }
    dcon::framed(other, bare.is_some())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::LineFaults;

    fn damaged(fault: &str) -> Vec<u8> {
        let mut faults = LineFaults::none(7);
        faults.add(fault, Some("1")).unwrap();
        let mut reply = b">+05.123\r".to_vec();
        faults.clash("timer", &mut reply, 0);
        faults.apply(b"#010", reply, 0).unwrap().1
    }

    #[test]
    fn a_flip_changes_one_bit() {
        let bytes = damaged("flip");
        let both = bytes.iter().zip(b">+05.123\r");
        let differing: u32 = both.map(|(a, b)| (a ^ b).count_ones()).sum();
        assert_eq!((bytes.len(), differing), (9, 1));
    }

    #[test]
    fn noise_and_echo_come_before_the_reply() {
        let noisy = damaged("noise");
        assert!(noisy.ends_with(b">+05.123\r") && (10..=13).contains(&noisy.len()));
        assert_eq!(damaged("echo"), b"#010\r>+05.123\r");
    }

    #[test]
    fn second_transmitter_and_wrong_baud_rate_destroy_the_reply() {
        for fault in ["clash", "garble"] {
            let bytes = damaged(fault);
            assert_ne!(bytes, b">+05.123\r", "{fault}");
            assert!(!bytes.is_empty(), "{fault}");
        }
    }
}
