//! Checks cleared motions pose by pose with an independent reading of the scene.
//!
//! The check reads bodies as boxes, moves them by sampled strokes and compares them pair by pair.

#![allow(clippy::unwrap_used)]

use super::boxes::{Boxed, boxed, gap, least_gap, moves_with, placed};
use super::*;
use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

/// Situations to try; each has one motion, and `POSES` poses if the guard clears it.
const SITUATIONS: usize = 3000;
const POSES: usize = 12;

/// Random numbers from a seed, the same on every machine.
struct Dice(SplitMix64);

impl Dice {
    fn below(&mut self, n: u64) -> u64 {
        self.0.next_u64() % n
    }
    fn within(&mut self, low: f64, high: f64) -> f64 {
        let fraction = match self.below(6) {
            0 => 0.0,
            1 => 1.0,
            _ => self.0.next_u64() as f64 / u64::MAX as f64,
        };
        low + fraction * (high - low)
    }
}

fn drawn(dice: &mut Dice, guard: &Guard) -> (Situation, Motion, Actuator) {
    let mut situation = rest();
    for actuator in Actuator::ALL {
        let (low, high) = guard.stroke_mm(actuator);
        match dice.below(8) {
            0 => situation.set(actuator, at(high)),
            1 => situation.set(actuator, moving(low, high)),
            2 => situation.set(actuator, at(dice.within(low, high))),
            _ => {}
        }
    }
    situation.parts = PartPlaces {
        pocket: false,
        on_pusher: dice.below(4) == 0,
        nest: dice.below(3) == 0,
        gripper: dice.below(4) == 0,
    };
    let actuator = Actuator::ALL[dice.below(8) as usize];
    let (low, high) = guard.stroke_mm(actuator);
    (
        situation,
        Motion::to(actuator, dice.within(low, high)),
        actuator,
    )
}

/// Returns strokes that the situation and the motion allow at some time.
fn pose(dice: &mut Dice, situation: &Situation, actuator: Actuator, target: f64) -> [f64; 8] {
    Actuator::ALL.map(|a| {
        let (low, high) = situation.position(a).unwrap().span_mm();
        let moves = a == actuator;
        let (low, high) = if moves {
            (low.min(target), high.max(target))
        } else {
            (low, high)
        };
        dice.within(low, high)
    })
}

/// Returns the first pair that is too near, in words.
fn too_near(settings: &GuardSettings, all: &[Boxed], actuator: Actuator) -> Option<String> {
    let (movers, others): (Vec<_>, Vec<_>) = all
        .iter()
        .partition(|body| moves_with(settings, body.rides, actuator));
    for (mover, other) in movers
        .iter()
        .flat_map(|m| others.iter().map(move |o| (m, o)))
    {
        let Some(least) = least_gap(settings, &mover.id, &other.id) else {
            continue;
        };
        let pairs = mover
            .boxes
            .iter()
            .flat_map(|a| other.boxes.iter().map(move |b| gap(a, b)));
        let found = pairs.fold(f64::INFINITY, f64::min);
        // Sums of a few numbers below 1e3 mm are accurate to 1e-12 mm.
        if found <= least - 1e-9 {
            return Some(format!("{} and {}: {found} mm", mover.id, other.id));
        }
    }
    None
}

#[test]
fn a_cleared_motion_is_clear_at_every_sampled_pose() {
    let settings = scene_settings();
    let bodies = boxed(&settings);
    let mut guard = guard();
    let mut dice = Dice(SplitMix64::seed_from_u64(22));
    let mut cleared = 0;
    for case in 0..SITUATIONS {
        let (situation, motion, actuator) = drawn(&mut dice, &guard);
        // A retracting pusher leaves its part behind, so the part is no longer in front of it.
        let leaves = actuator == Actuator::Pusher && situation.parts.on_pusher;
        if leaves || guard.clear(&motion, &situation).is_err() {
            continue;
        }
        cleared += 1;
        for _ in 0..POSES {
            let mm = pose(
                &mut dice,
                &situation,
                actuator,
                motion.target_mm(actuator).unwrap(),
            );
            let all = placed(&settings, &bodies, &situation.parts, &mm);
            if let Some(words) = too_near(&settings, &all, actuator) {
                panic!("case {case}: {words} at {mm:?} after {motion:?} in {situation:?}");
            }
        }
    }
    assert!(
        cleared > SITUATIONS / 5,
        "only {cleared} of {SITUATIONS} were cleared: too few for a proof"
    );
}
