//! Random bytes from a seed: half of the inputs resemble requests, a quarter are damaged requests, a quarter arbitrary
//! bytes. After each input without an answer, the module must report exactly the same registers as before.

use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use rigsim::bench;
use rigsim::rig::Rig;

const MODELS: [&str; 15] = [
    "I-7017", "I-7017F", "I-7018", "I-7021", "I-7021P", "I-7022", "I-7024", "I-7033", "I-7041",
    "I-7043", "I-7050", "I-7060", "I-7080", "I-7080D", "M-7067",
];

/// Requests that change nothing and together read all registers of a module; a module may not know some of them.
const QUERIES: [&str; 16] = [
    "$2", "$6", "$M", "~0", "~2", "@", "$8", "~4", "~4P", "~4S", "$A", "$B", "$4", "@G0", "$31",
    "@DI",
];

/// Count of inputs by their effect.
#[derive(Debug, Default)]
pub struct Tally {
    /// Inputs with an answer.
    pub answered: u64,
    /// Inputs without an answer.
    pub unheard: u64,
}

struct Random(SplitMix64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0.next_u64()
    }

    fn below(&mut self, most: usize) -> usize {
        (self.next() >> 16) as usize % most
    }

    fn byte_of(&mut self, alphabet: &[u8]) -> u8 {
        alphabet[self.below(alphabet.len())]
    }
}

/// Builds a bench with one module of the model, with or without checksum.
fn module(model: &str, checksum: bool) -> Rig {
    let file = format!("[[module]]\naddress = 1\nmodel = \"{model}\"\nchecksum = {checksum}");
    bench::build_text(&file).expect("a bench")
}

fn with_checksum(text: &str, checksum: bool) -> Vec<u8> {
    let sum = text.bytes().fold(0u8, u8::wrapping_add);
    let end = if checksum {
        format!("{sum:02X}")
    } else {
        String::new()
    };
    format!("{text}{end}").into_bytes()
}

/// Reads all registers of a module. Skips `$4`, which clears the sample of a digital module and stores the value
/// of an analog output.
fn registers(rig: &mut Rig, model: &str, checksum: bool) -> Vec<Option<Vec<u8>>> {
    let counter = model.starts_with("I-7080");
    let asks = QUERIES.iter().filter(|ask| counter || **ask != "$4");
    asks.map(|ask| {
        let (lead, body) = ask.split_at(1);
        let text = with_checksum(&format!("{lead}01{body}"), checksum);
        rig.exchange(0, &text, 0).map(|reply| reply.bytes)
    })
    .collect()
}

fn input(random: &mut Random) -> Vec<u8> {
    const BODIES: [&str; 14] = [
        "2",
        "5",
        "6",
        "A",
        "05.000",
        "0+05.000",
        "FFFF",
        "0AFF",
        "~3164",
        "015S",
        "0H00010",
        "PA00000010",
        "01080600",
        "RD1E",
    ];
    let kind = random.below(4);
    let mut text = vec![random.byte_of(b"#$%@~"), b'0', b'1'];
    match kind {
        0 => {
            let length = random.below(30);
            return (0..length).map(|_| random.next() as u8).collect();
        }
        1 => {
            text.extend(BODIES[random.below(BODIES.len())].bytes());
            let bit = random.below(text.len() * 8);
            text[bit / 8] ^= 1 << (bit % 8);
        }
        _ => {
            let length = random.below(12);
            let more = (0..length).map(|_| random.byte_of(b"0123456789ABCDEFGHILMNOPRST+-.* "));
            text.extend(more.collect::<Vec<u8>>());
        }
    }
    text
}

/// Sends this many inputs to every model in turn.
pub fn throw(seed: u64, inputs: u64) -> Tally {
    let mut random = Random(SplitMix64::seed_from_u64(seed));
    let mut seen = Tally::default();
    for (place, model) in MODELS.iter().cycle().take(2 * MODELS.len()).enumerate() {
        let checksum = place >= MODELS.len();
        let mut rig = module(model, checksum);
        let mut before = registers(&mut rig, model, checksum);
        for number in 0..inputs / (2 * MODELS.len() as u64) {
            let mut text = input(&mut random);
            let is_whole = checksum && number % 2 == 0;
            if is_whole {
                let sum = text.iter().fold(0u8, |sum, byte| sum.wrapping_add(*byte));
                text.extend(format!("{sum:02X}").bytes());
            }
            let writes = rig.eeprom_writes();
            let reply = rig.exchange(0, &text, 0);
            let broadcast = text.get(1..3) == Some(b"**");
            match reply {
                Some(reply) => {
                    seen.answered += 1;
                    assert_eq!(reply.bytes.last(), Some(&b'\r'), "{model} {text:?}");
                    // The input may have changed the address or the checksum setting: continue with a fresh
                    // module.
                    if text.first() == Some(&b'%') {
                        rig = module(model, checksum);
                    }
                    before = registers(&mut rig, model, checksum);
                }
                None if broadcast => before = registers(&mut rig, model, checksum),
                None => {
                    seen.unheard += 1;
                    assert_eq!(rig.eeprom_writes(), writes, "{model} {text:?}");
                    let after = registers(&mut rig, model, checksum);
                    assert!(after == before, "seed {seed}, {model}: {text:?} changed it");
                }
            }
        }
    }
    seen
}
