//! The scenario of a seed: a rig, faults of world and line, and the lives of the controller. A life is one run of the
//! controller program, from its start to its end or kill.
//!
//! No fault lasts beyond [`CEASES_US`] of rig time: at that time the study cancels each fault that still waits for its
//! part. Lives that start later have no faults.

use super::climate::Climate;
use crate::dice::Dice;
use machine::rig::wiring::Wiring;

/// Number of different rigs; the seeds share them, so that the study calibrates each only once.
pub const RIGS: u64 = 8;
/// End of all faults, microseconds of rig time.
pub const CEASES_US: u64 = 16_000_000;
/// Duration of a long fault of door, emergency stop, air or circuit, microseconds.
pub const LONG_US: u64 = 3_000_000;
/// Durations of short faults of these, microseconds: from a break that one reading sees to one as long as a stage of a
/// test.
const SHORT_US: (u64, u64) = (500, 200_000);

/// Faults that happen once, at the part with the drawn number.
const AT_A_PART: [&str; 10] = [
    "jam_pusher",
    "stuck_clamp",
    "no_part",
    "double_part",
    "fall",
    "probe_dirty",
    "beam_blind",
    "axis_alarm",
    "stuck_lift",
    "stuck_gripper",
];
/// Faults of safety inputs, at an instant; the rig must drive no motion during them.
const SAFETY: [&str; 3] = ["door", "estop", "air"];
/// Faults that hit single replies or requests; the scenario draws a probability for each fault that it uses.
const OF_A_REPLY: [&str; 8] = [
    "drop", "deaf", "truncate", "late", "flip", "noise", "garble", "delay",
];

/// Plan of one life of the controller.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Life {
    /// Parts of the lot that the life runs.
    pub count: u64,
    /// Whether an operator gives random orders.
    pub attended: bool,
    /// Time from the start of the program to its kill, microseconds; `None` for a life that ends by itself.
    pub killed_after_us: Option<u64>,
    /// Time from the end of the previous life to the start of this one, microseconds.
    pub pause_us: u64,
}

impl Life {
    /// Returns a life without operator and without kill.
    pub fn calm(count: u64, pause_us: u64) -> Self {
        Self {
            count,
            attended: false,
            killed_after_us: None,
            pause_us,
        }
    }
}

/// Everything that a seed of the storm determines.
#[derive(Debug, Clone)]
pub struct Scenario {
    /// Seed of the rig, from 1 to [`RIGS`]; it determines the errors of the modules and the stroke times.
    pub rig: u64,
    /// Whether the first life begins without a calibration and therefore measures references and reference parts first.
    pub uncalibrated: bool,
    /// Faults of the simulated rig, in the form of `--fault`.
    pub faults: Vec<String>,
    /// Duration of the faults that begin at an instant, microseconds: [`LONG_US`], or in one storm of three over
    /// solid-state relays a short one.
    pub hold_us: u64,
    /// Instants at which a safety input is disturbed, microseconds.
    pub disturbed_us: Vec<u64>,
    /// Instants from which a contactor stays closed once it is closed, for `hold_us`, microseconds.
    pub welded_us: Vec<u64>,
    /// Whether a line may be deaf or slow for a while: outputs then stay on until the watchdogs of their modules
    /// expire.
    pub lines_disturbed: bool,
    /// Lives while faults happen.
    pub lives: Vec<Life>,
    /// Random numbers of the operator.
    pub operator_dice: Dice,
}

impl Scenario {
    /// Draws the scenario of a seed; lots have at most `parts` parts.
    pub fn of(seed: u64, parts: u64, wiring: &Wiring, climate: &Climate) -> Self {
        let mut dice = Dice::new(seed);
        let operator_dice = dice.apart();
        let uncalibrated = dice.once_in(16) && climate.calibrates;
        let mut scenario = Self {
            rig: 1 + seed % RIGS,
            uncalibrated,
            faults: vec![format!("parts_seed={}", seed % (1 << 40))],
            hold_us: LONG_US,
            disturbed_us: Vec::new(),
            welded_us: Vec::new(),
            lines_disturbed: false,
            lives: lives(&mut dice, uncalibrated, parts),
            operator_dice,
        };
        for _ in 0..dice.below(4) {
            scenario.add_world_fault(&mut dice);
        }
        if dice.once_in(2) {
            scenario.lines_disturbed = true;
            for _ in 0..dice.between(1, 4) {
                let fault = line_fault(&mut dice, wiring);
                scenario.faults.push(fault);
            }
        }
        if climate.is_of_circuits() {
            scenario.add_circuit_faults(&mut dice, wiring, climate);
            if dice.once_in(3) {
                scenario.hold_us = dice.between(SHORT_US.0, SHORT_US.1);
            }
        }
        scenario
    }

    fn add_circuit_faults(&mut self, dice: &mut Dice, wiring: &Wiring, climate: &Climate) {
        for _ in 0..dice.below(3) {
            let at_us = dice.between(0, CEASES_US - LONG_US);
            let fault = climate.circuit_fault(dice);
            if self.faults.iter().any(|it| it.starts_with(fault)) {
                continue;
            }
            self.faults
                .push(format!("{fault}={:.6}", at_us as f64 * 1e-6));
            if fault.ends_with("_welded") {
                self.welded_us.push(at_us);
            }
        }
        if dice.once_in(2) {
            for _ in 0..dice.between(1, 4) {
                let window = window(dice);
                let fault = climate.instrument_fault(dice, wiring, &window);
                self.faults.push(fault);
            }
        }
    }

    fn add_world_fault(&mut self, dice: &mut Dice) {
        if dice.once_in(3) {
            let at_us = dice.between(0, CEASES_US - LONG_US);
            let fault = *dice.one(&SAFETY);
            // Two overlapping disturbances of one input would both end when the first one ends.
            if self.faults.iter().any(|it| it.starts_with(fault)) {
                return;
            }
            self.faults
                .push(format!("{fault}={:.6}", at_us as f64 * 1e-6));
            self.disturbed_us.push(at_us);
        } else {
            let (fault, part) = (dice.one(&AT_A_PART), dice.between(1, 7));
            self.faults.push(format!("{fault}={part}"));
        }
    }
}

fn lives(dice: &mut Dice, uncalibrated: bool, parts: u64) -> Vec<Life> {
    let mut life = |may_be_killed: bool| Life {
        count: dice.between(1, parts.max(1) + 1),
        attended: dice.once_in(2),
        killed_after_us: (may_be_killed && dice.once_in(2))
            .then(|| dice.between(100_000, 10_000_000)),
        pause_us: dice.between(1_000, 4_000_000),
    };
    if uncalibrated {
        return vec![life(false)];
    }
    let first = life(true);
    let more = u64::from(first.killed_after_us.is_some());
    std::iter::once(first)
        .chain((0..more).map(|_| life(true)))
        .collect()
}

/// Draws the window in which a fault acts, in seconds of rig time: `FROM..UNTIL`.
fn window(dice: &mut Dice) -> String {
    let seconds = |us: u64| us as f64 * 1e-6;
    let from = dice.below(CEASES_US - 1_000_000);
    let until = (from + dice.between(50_000, 6_000_000)).min(CEASES_US);
    format!("{:.6}..{:.6}", seconds(from), seconds(until))
}

/// Draws a fault of a line or a module, with the interval in which it acts.
fn line_fault(dice: &mut Dice, wiring: &Wiring) -> String {
    let window = window(dice);
    let from = window.split("..").next().unwrap_or_default();
    let module = &dice.one(&wiring.modules).name;
    let line = &dice.one(&wiring.lines).name;
    match dice.below(8) {
        0 => format!("reset={module}@{from}"),
        1 => format!("watchdog_trip={module}@{from}"),
        2 => format!("silence={module}@{window}"),
        3 => format!("line_cut={line}@{window}"),
        4 => format!("port_lost={line}@{window}"),
        _ => {
            let fault = *dice.one(&OF_A_REPLY);
            let chance = *dice.one(&["0.0005", "0.005", "0.05"]);
            match fault {
                "late" => format!("late={chance}/{}@{window}", dice.between(20, 300)),
                "delay" => format!("delay={}@{window}", dice.between(1, 40)),
                fault => format!("{fault}={chance}@{window}"),
            }
        }
    }
}
