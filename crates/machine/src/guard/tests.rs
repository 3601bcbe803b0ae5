//! Tests of the guard on the real `config/scene.toml`.

#![allow(clippy::unwrap_used)]

mod boxes;
mod clearance;
mod cycle;
mod interlock;
mod ledger;
mod refused;
mod sampled;
mod settings;

use super::*;

const SCENE: &str = include_str!("../../../../config/scene.toml");

fn scene_settings() -> GuardSettings {
    toml::from_str(SCENE).unwrap()
}

fn guard() -> Guard {
    Guard::build(&scene_settings()).unwrap()
}

fn jzc_22f() -> PartSize {
    PartSize {
        body_mm: [22.5, 16.5, 16.5],
        pin_length_mm: 3.5,
    }
}

fn rest() -> Situation {
    Situation::at_rest(jzc_22f())
}

fn at(mm: f64) -> Position {
    Position::At(mm)
}

fn moving(from_mm: f64, to_mm: f64) -> Position {
    Position::Between { from_mm, to_mm }
}

/// Both jaws, as their one valve moves them.
fn clamp(to_mm: f64) -> Motion {
    Motion::group(
        &[Actuator::JawLeft, Actuator::JawRight].map(|actuator| Stroke { actuator, to_mm }),
    )
}

impl Situation {
    fn clamped(self) -> Situation {
        self.with(Actuator::JawLeft, at(8.0))
            .with(Actuator::JawRight, at(8.0))
    }

    fn parts(mut self, change: impl FnOnce(&mut PartPlaces)) -> Situation {
        change(&mut self.parts);
        self
    }
}

fn blocked(motion: Motion, situation: &Situation) -> Blocked {
    match guard().clear(&motion, situation).unwrap_err() {
        Refusal::Blocked(blocked) => *blocked,
        other => panic!("refused for another reason: {other}"),
    }
}

fn passes(motion: Motion, situation: &Situation) {
    if let Err(refusal) = guard().clear(&motion, situation) {
        panic!("{refusal}");
    }
}
