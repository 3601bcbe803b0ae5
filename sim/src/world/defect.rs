//! What can be wrong with a relay, and which parts of a lot have it.

use super::draw::{Draw, Subject};

macro_rules! defects {
    ($($(#[$doc:meta])* $name:ident = $text:literal),* $(,)?) => {
        /// A defect of the simulated lot.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Defect { $($(#[$doc])* $name),* }

        impl Defect {
            /// Every kind.
            pub const ALL: &'static [Defect] = &[$(Defect::$name),*];

            /// Name in the truth.
            pub fn name(self) -> &'static str {
                match self { $(Defect::$name => $text),* }
            }
        }
    };
}

defects! {
    /// No current at all.
    OpenCoil = "open_coil",
    /// Resistance too low.
    ShortedTurns = "shorted_turns",
    /// A winding for another voltage.
    WrongCoil = "wrong_coil",
    /// Releases too low.
    WeakSpring = "weak_spring",
    /// Operates too high.
    StiffSpring = "stiff_spring",
    /// Operates or releases late.
    Slow = "slow",
    /// Bounces too long on one contact.
    Bouncing = "bouncing",
    /// NC welded: never opens, NO never makes.
    StuckNc = "stuck_nc",
    /// NO welded: never opens, NC never makes.
    StuckNo = "stuck_no",
    /// One contact has too much resistance.
    HighContact = "high_contact",
    /// One contact has another, always too high, resistance at every closure.
    UnstableContact = "unstable_contact",
    /// Lies in the nest the wrong way round: coil and common miss their pins.
    Turned = "turned",
    /// One pin is not there.
    MissingPin = "missing_pin",
}

/// The defect of a lot part: in each block of (kinds / rate) parts every kind appears once, at a
/// place of its own that the seed chooses.
pub fn of_part(seed: u64, index: u64, rate_pct: f64) -> Option<Defect> {
    if rate_pct <= 0.0 {
        return None;
    }
    let kinds = Defect::ALL.len() as u64;
    let block = ((kinds as f64 * 100.0 / rate_pct).round() as u64).max(kinds);
    let mut draw = Draw::new(seed, Subject::DefectBlock, index / block);
    let mut taken: Vec<u64> = Vec::with_capacity(Defect::ALL.len());
    for &defect in Defect::ALL {
        let mut place = draw.below(block);
        while taken.contains(&place) {
            place = (place + 1) % block;
        }
        if place == index % block {
            return Some(defect);
        }
        taken.push(place);
    }
    None
}
