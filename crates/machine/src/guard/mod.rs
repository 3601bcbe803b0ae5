//! The collision guard: no actuator of the rig moves without its clearance.
//!
//! **Input.** A [`Motion`] (one actuator, or several on one valve) in a [`Situation`]: known positions of all
//! actuators, places of the parts, and their size. **Output.** [`Cleared`], which only this module can make and which
//! the drive demands, or a [`Refusal`] with both bodies, their distance, the place, the last clear pose, and a remedy.
//!
//! **Bodies.** Fixed elements, tooling that rides on actuators (sort z rides on the axis, the
//! gripper on sort z) and the part, pins included, in each of its places; all from `scene.toml`.
//!
//! **Coordinates of a situation.** Strokes count from the rest end. A jaw or finger stopped by a part is `At` its full
//! stroke. A moving actuator is `Between` its start and its target until the end sensor responds. A part being pushed
//! is `on_pusher`; a gripped one remains `nest` until the jaws are open.
//!
//! **Rules.**
//! 1. Any two bodies keep the default margin, unless a pair rule says otherwise.
//! 2. An actuator in motion or in doubt occupies its whole span, and one of unknown position its whole stroke. Two
//!    motions that overlap in time are therefore checked against each other's swept room, because the situation of each
//!    shows the other's actuator as [`Between`](Position::Between).
//! 3. A mover of unknown start is swept from the far end of its span.
//! 4. The guard refuses NaN, a position off its stroke, and a part without size.
//! 5. A motion with an [`Interlock`] needs its input, whatever the bodies say.
//!
//! **Why a cleared motion is clear.** For every combination of true positions that the situation allows, each resting
//! body lies in its room (`occupancy`) and each moving one in the sweep of its room (`sweep`); the collision core
//! proves that sweep and rooms stay further apart than the margin. The tests check this independently at sampled
//! poses.
//!
//! **Not handled.** Time: the guard never assumes that a body has moved out of the way already. Two actuators of
//! unknown position that occupy the same room block each other; a person has to jog one of them. Parts in places
//! without a sensor.

mod actuator;
mod advice;
mod axes;
mod back_track;
mod bodies;
mod build;
mod carried;
mod drawing;
mod error;
mod interlock;
mod judge;
mod memory;
mod motion;
mod occupancy;
mod part;
mod refusal;
mod rules;
mod scene;
mod settings;
mod situation;
mod space;
mod sweep;
#[cfg(test)]
mod tests;

pub use actuator::{Actuator, Position};
pub use drawing::Drawn;
pub use error::GuardError;
pub use interlock::{End, Interlock};
pub use motion::{Cleared, Motion, Stroke};
pub use refusal::{Blocked, Refusal};
pub use settings::{
    ActuatorSettings, Element, GuardSettings, PairRule, PairSettings, Piece, Policy, PoseSettings,
    ShapeKind,
};
pub use situation::{PartPlaces, PartSize, Situation};

use memory::{Memory, Question};
use scene::Scene;
use space::Space;
use sweep::FirstContact;

/// Returns the ids of the part in a scene, one for each place.
pub fn part_names() -> [&'static str; 5] {
    part::Role::ALL.map(part::Role::id)
}

/// The collision guard of one rig.
#[derive(Debug, Clone)]
pub struct Guard {
    scene: Scene,
    space: Space,
    memory: Memory,
    interlocks: Vec<Interlock>,
}

impl Guard {
    /// Resolves the scene; checks that each actuator but the escapement has its stroke free in the empty rig at rest.
    ///
    /// # Errors
    /// Fails with a [`GuardError`] that names the place in `scene.toml`.
    pub fn build(settings: &GuardSettings) -> Result<Guard, GuardError> {
        let scene = build::scene_of(settings)?;
        let space = Space::of(&scene).map_err(|flaw| GuardError::Body {
            path: "elements".to_owned(),
            flaw,
        })?;
        let mut guard = Guard {
            scene,
            space,
            memory: Memory::default(),
            interlocks: Vec::new(),
        };
        guard.try_every_stroke()?;
        Ok(guard)
    }

    /// Returns this guard with the interlocks of the plant.
    #[must_use]
    pub fn with_interlocks(mut self, interlocks: Vec<Interlock>) -> Guard {
        assert!(
            interlocks.len() <= Situation::INTERLOCKS,
            "too many interlocks"
        );
        (self.interlocks, self.memory) = (interlocks, Memory::default());
        self
    }

    /// Clears `motion` in `situation` or refuses it. Equal inputs give equal results; for repeated inputs the guard
    /// remembers the result.
    ///
    /// # Errors
    /// Fails with a [`Refusal`], which is a normal result: show it and do not move.
    pub fn clear(&mut self, motion: &Motion, situation: &Situation) -> Result<Cleared, Refusal> {
        let question = Question::of(motion, situation);
        let answer = match self.memory.answer(&question) {
            Some(answer) => answer,
            None => {
                let answer = self.decide(motion, situation);
                self.memory.keep(question, answer.clone());
                answer
            }
        };
        answer.map(|()| Cleared::new(*motion))
    }

    /// Returns the least distance in mm that `motion` keeps from the bodies that it must not touch; `None` beyond
    /// `range_mm` and for a motion that [`Guard::clear`] refuses.
    pub fn clearance_mm(
        &mut self,
        motion: &Motion,
        situation: &Situation,
        range_mm: f64,
    ) -> Option<f64> {
        self.clear(motion, situation).ok()?;
        let (scene, space) = (&self.scene, &mut self.space);
        let strokes = motion.strokes();
        let least = strokes.filter_map(|stroke| {
            let meanwhile = judge::with_others_under_way(scene, motion, situation, stroke.actuator);
            sweep::least_mm(scene, space, &meanwhile, &stroke, range_mm).ok()?
        });
        least.min_by(f64::total_cmp)
    }

    /// Returns the low and high end of an actuator's stroke, mm.
    pub fn stroke_mm(&self, actuator: Actuator) -> (f64, f64) {
        self.scene.axis(actuator).stroke_mm
    }

    /// Returns the least distance from an end, mm, at which the sensor of that end goes off; 0 when unknown.
    pub fn sensor_off_mm(&self, actuator: Actuator) -> f64 {
        self.scene.axis(actuator).sensor_off_mm
    }

    /// Returns true when the probes may rise to a part between closed jaws while the pusher returns, once the sensor of
    /// the extended pusher is off; wherever axis, z and fingers are.
    pub fn probes_rise_beside_pusher(&mut self, part_size: PartSize) -> bool {
        let whole = |(from_mm, to_mm)| Position::Between { from_mm, to_mm };
        let (home_mm, out_mm) = self.stroke_mm(Actuator::Pusher);
        let left_mm = out_mm - self.sensor_off_mm(Actuator::Pusher);
        let mut situation =
            Situation::at_rest(part_size).with(Actuator::Pusher, whole((home_mm, left_mm)));
        for actuator in [Actuator::JawLeft, Actuator::JawRight] {
            situation.set(actuator, Position::At(self.stroke_mm(actuator).1));
        }
        for actuator in [Actuator::SortAxis, Actuator::SortZ, Actuator::Gripper] {
            situation.set(actuator, whole(self.stroke_mm(actuator)));
        }
        situation.parts.nest = true;
        let (_, up_mm) = self.stroke_mm(Actuator::ProbeLift);
        self.clear(&Motion::to(Actuator::ProbeLift, up_mm), &situation)
            .is_ok()
    }

    fn decide(&mut self, motion: &Motion, situation: &Situation) -> Result<(), Refusal> {
        interlock::check(&self.interlocks, motion, situation, |it| self.stroke_mm(it))?;
        match judge::judge(&self.scene, &mut self.space, motion, situation)? {
            None => Ok(()),
            Some(finding) => {
                let (scene, space) = (&self.scene, &mut self.space);
                let last_clear_mm = back_track::last_clear_mm(scene, space, situation, &finding);
                let would_help = advice::advice(scene, space, situation, motion, &finding);
                Err(self.refusal(&finding, last_clear_mm, would_help))
            }
        }
    }

    fn refusal(
        &self,
        finding: &FirstContact,
        last_clear_mm: Option<f64>,
        would_help: String,
    ) -> Refusal {
        let blocker = finding
            .blocker
            .map_or("(undecidable)", |number| self.scene.id(number));
        Refusal::Blocked(Box::new(Blocked {
            stroke: finding.stroke,
            mover: self.scene.id(finding.mover).to_owned(),
            blocker: blocker.to_owned(),
            distance_mm: finding.distance_mm,
            margin_mm: finding.margin_mm,
            at_fraction: finding.at_fraction,
            at: finding.at,
            last_clear_mm,
            would_help,
        }))
    }

    fn try_every_stroke(&mut self) -> Result<(), GuardError> {
        // A part in no place: only its size must be valid.
        let nowhere = PartSize {
            body_mm: [1.0; 3],
            pin_length_mm: 0.0,
        };
        let rest = Situation::at_rest(nowhere);
        for actuator in Actuator::ALL
            .into_iter()
            .filter(|actuator| *actuator != Actuator::Escapement)
        {
            let (low, high) = self.stroke_mm(actuator);
            let start = rest.with(actuator, Position::At(low));
            if let Err(refusal) = self.decide(&Motion::to(actuator, high), &start) {
                return Err(GuardError::StrokeBlocked {
                    actuator,
                    refusal: Box::new(refusal),
                });
            }
        }
        Ok(())
    }
}
