//! What a seed of the storm draws: parts, faults with their instants, and perhaps a kill.

use crate::dice::Dice;
use machine::rig::wiring::Wiring;
use std::fmt;

/// Most parts of a lot: one small batch.
const PARTS: u64 = 6;
/// Instants between which faults strike and the program is killed, s: from loading to the end of a batch.
const INSTANTS_S: [u64; 2] = [30, 4_500];

/// What a fault demands of the heater.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Demand {
    /// Off within two seconds, and for the rest of this life.
    OffForThisLife,
    /// Off within two seconds, and in every later life.
    OffForGood,
    /// Nothing at once: the fault shows slowly, or only in temperatures.
    Nothing,
}

/// Faults of the chamber.
const OF_CHAMBER: [(&str, Demand); 22] = [
    ("limiter", Demand::OffForGood),
    ("mains_off", Demand::OffForGood),
    ("control_open", Demand::OffForGood),
    ("reference_open", Demand::OffForGood),
    ("door", Demand::OffForThisLife),
    ("estop", Demand::OffForThisLife),
    ("control_short", Demand::OffForThisLife),
    ("reference_short", Demand::OffForThisLife),
    ("fan_stopped", Demand::Nothing),
    ("heater_open", Demand::Nothing),
    ("ssr_stuck", Demand::Nothing),
    ("control_stuck", Demand::Nothing),
    ("reference_stuck", Demand::Nothing),
    ("control_drift", Demand::Nothing),
    ("reference_drift", Demand::Nothing),
    ("heater_half", Demand::Nothing),
    ("fan_slow", Demand::Nothing),
    ("vent_stuck", Demand::Nothing),
    ("mains_low", Demand::Nothing),
    ("thermocouple_open", Demand::Nothing),
    ("rack_open", Demand::Nothing),
    ("rack_stuck", Demand::Nothing),
];
/// Faults of single replies or requests.
const OF_A_REPLY: [&str; 4] = ["drop", "deaf", "truncate", "garble"];
const CHANCES: [&str; 3] = ["0.0005", "0.005", "0.05"];

/// A fault of the chamber.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Strike {
    pub name: &'static str,
    pub demand: Demand,
    /// Instant, s of rig time.
    pub at_s: u64,
}

/// Everything that a seed determines besides the rig.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Scenario {
    /// Parts of the lot.
    pub parts: u64,
    /// Faults of the chamber.
    pub strikes: Vec<Strike>,
    /// Faults of line and modules, as `--fault` takes them.
    pub of_line: Vec<String>,
    /// Time from the start of the program to its kill, s; `None` for a life that ends by itself.
    pub killed_after_s: Option<u64>,
}

impl Scenario {
    /// Draws the scenario of a seed.
    pub fn of(seed: u64, wiring: &Wiring) -> Self {
        let mut dice = Dice::new(seed);
        let [from, to] = INSTANTS_S;
        let strikes = (0..dice.below(4)).map(|_| {
            let (name, demand) = *dice.one(&OF_CHAMBER);
            let at_s = dice.between(from, to);
            Strike { name, demand, at_s }
        });
        let strikes: Vec<Strike> = strikes.collect();
        let lines = if dice.once_in(3) {
            dice.between(1, 3)
        } else {
            0
        };
        Self {
            parts: dice.between(1, PARTS + 1),
            of_line: (0..lines).map(|_| of_line(&mut dice, wiring)).collect(),
            killed_after_s: dice.once_in(3).then(|| dice.between(from, to)),
            strikes,
        }
    }

    /// Returns all faults, as `--fault` takes them.
    pub fn faults(&self) -> Vec<String> {
        let of_chamber = self
            .strikes
            .iter()
            .map(|it| format!("{}={}", it.name, it.at_s));
        of_chamber.chain(self.of_line.iter().cloned()).collect()
    }
}

impl fmt::Display for Scenario {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let faults = self.faults();
        write!(f, "{} parts, faults {}", self.parts, faults.join(" "))?;
        match self.killed_after_s {
            Some(seconds) => write!(f, ", killed after {seconds} s"),
            None => Ok(()),
        }
    }
}

/// Draws a fault of the line or of a module, with the time in which it acts.
fn of_line(dice: &mut Dice, wiring: &Wiring) -> String {
    let [from, to] = INSTANTS_S;
    let from_s = dice.between(from, to);
    let window = format!("{from_s}..{}", from_s + dice.between(1, 120));
    let module = &dice.one(&wiring.modules).name;
    match dice.below(4) {
        0 => format!("reset={module}@{from_s}"),
        1 => format!("silence={module}@{window}"),
        2 => format!("delay={}@{window}", dice.between(1, 40)),
        _ => format!("{}={}@{window}", dice.one(&OF_A_REPLY), dice.one(&CHANCES)),
    }
}
