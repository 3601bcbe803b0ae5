//! What a seed draws: a rig, faults of world and line, and the lives of the controller.
//!
//! Everything that strikes has struck, or has ended, [`CEASES_US`] after the start; what still waits for its part
//! is called off then. The lives after that are calm.

use crate::dice::Dice;
use machine::rig::wiring::Wiring;

/// Rigs that the seeds share; each is calibrated once.
pub const RIGS: u64 = 8;
/// The storm has passed, microseconds of rig time.
pub const CEASES_US: u64 = 16_000_000;
/// Door, emergency stop and air are disturbed for so long, microseconds: `fault_hold_ms` of the storm's world.
pub const DISTURBED_US: u64 = 3_000_000;
/// What the storm's world has in place of the default: more defects, so that every bin is used.
pub const WORLD: &str = "[defects]\nrate_pct = 25.0\n\n[mechanism]\nfault_hold_ms = 3000.0\n";

/// Strike once at a part.
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
/// Strike at an instant; while they do nothing may be driven.
const SAFETY: [&str; 3] = ["door", "estop", "air"];
/// Of replies and requests, each with a probability.
const OF_A_REPLY: [&str; 8] = [
    "drop", "deaf", "truncate", "late", "flip", "noise", "garble", "delay",
];

/// One life of the controller.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Life {
    /// Parts of its lot.
    pub count: u64,
    /// A restless operator stands at the screen.
    pub attended: bool,
    /// The program is killed so long after its start, microseconds.
    pub killed_after_us: Option<u64>,
    /// Nobody starts it before so long after the life before, microseconds.
    pub pause_us: u64,
}

/// Everything that a seed draws.
#[derive(Debug, Clone)]
pub struct Weather {
    /// Draws errors of the modules and stroke times; one of [`RIGS`].
    pub rig: u64,
    /// The first life begins without a calibration: references and golden parts come first.
    pub uncalibrated: bool,
    /// For the simulated rig.
    pub faults: Vec<String>,
    /// When a safety input is disturbed, microseconds.
    pub disturbed_us: Vec<u64>,
    /// A line may be deaf or slow for a while, so that outputs wait for the watchdogs of their modules.
    pub lines_suffer: bool,
    /// Lives under the storm.
    pub lives: Vec<Life>,
    /// Of the operator.
    pub whims: Dice,
}

impl Weather {
    /// The weather of a seed; lots have `parts` parts at most.
    pub fn of(seed: u64, parts: u64, wiring: &Wiring) -> Self {
        let mut dice = Dice::new(seed);
        let whims = dice.apart();
        let uncalibrated = dice.once_in(16);
        let mut weather = Self {
            rig: 1 + seed % RIGS,
            uncalibrated,
            faults: vec![format!("parts_seed={}", seed % (1 << 40))],
            disturbed_us: Vec::new(),
            lines_suffer: false,
            lives: lives(&mut dice, uncalibrated, parts),
            whims,
        };
        for _ in 0..dice.below(4) {
            weather.of_the_world(&mut dice);
        }
        if dice.once_in(2) {
            weather.lines_suffer = true;
            for _ in 0..dice.between(1, 4) {
                let fault = of_a_line(&mut dice, wiring);
                weather.faults.push(fault);
            }
        }
        weather
    }

    fn of_the_world(&mut self, dice: &mut Dice) {
        if dice.once_in(3) {
            let at_us = dice.between(0, CEASES_US - DISTURBED_US);
            let fault = *dice.one(&SAFETY);
            // The same input twice would calm down with the first of both.
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

/// A fault of a line or a module with its window.
fn of_a_line(dice: &mut Dice, wiring: &Wiring) -> String {
    let seconds = |us: u64| us as f64 * 1e-6;
    let from = dice.below(CEASES_US - 1_000_000);
    let until = (from + dice.between(50_000, 6_000_000)).min(CEASES_US);
    let window = format!("{:.6}..{:.6}", seconds(from), seconds(until));
    let module = &dice.one(&wiring.modules).name;
    let line = &dice.one(&wiring.lines).name;
    match dice.below(8) {
        0 => format!("reset={module}@{:.6}", seconds(from)),
        1 => format!("watchdog_trip={module}@{:.6}", seconds(from)),
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
