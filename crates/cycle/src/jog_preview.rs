//! Shows how the guard decides on the motions that a person may order next, and on the one that it refused last.

use super::Cycle;
use machine::guard::{Position, Refusal, Situation};
use machine::handling::moves::Move;
use machine::station::orders;
use machine::view::{MotionView, RefusedView, StrokeView};
use texts::Lang;
use units::RigTime;

/// Largest distance between bodies that is shown, mm.
const RANGE_MM: f64 = 25.0;

impl Cycle {
    /// Returns the guard's decision on every motion that may be jogged now; empty while jogging is not allowed.
    pub(super) fn jog_preview(&mut self, now: RigTime) -> Vec<MotionView> {
        if self.station.may_jog().is_err() {
            return Vec::new();
        }
        let situation = self.station.situation(now, &self.image);
        let jogs = orders::JOGS.into_iter();
        jogs.map(|movement| {
            let motion = self.station.motion(movement);
            match self.guard.clear(&motion, &situation) {
                Ok(_) => MotionView {
                    clearance_mm: self.guard.clearance_mm(&motion, &situation, RANGE_MM),
                    ..self.shown(movement, &situation)
                },
                Err(refusal) => self.refused_motion(movement, &situation, &refusal),
            }
        })
        .collect()
    }

    /// Returns a refused motion with the body that blocks it.
    pub(super) fn refused_motion(
        &self,
        movement: Move,
        situation: &Situation,
        refusal: &Refusal,
    ) -> MotionView {
        let message = refusal.message();
        let [text, text_zh] = [Lang::En, Lang::Zh].map(|lang| message.say(lang));
        let refused = match refusal {
            Refusal::Blocked(blocked) => RefusedView {
                mover: blocked.mover.clone(),
                blocker: blocked.blocker.clone(),
                distance_mm: blocked.distance_mm,
                margin_mm: blocked.margin_mm,
                at: blocked.at,
                last_clear_mm: blocked.last_clear_mm,
                text,
                text_zh,
            },
            Refusal::OutOfStroke { .. } | Refusal::PartSize { .. } => RefusedView {
                text,
                text_zh,
                ..RefusedView::default()
            },
        };
        MotionView {
            refused: Some(refused),
            ..self.shown(movement, situation)
        }
    }

    fn shown(&self, movement: Move, situation: &Situation) -> MotionView {
        let motion = self.station.motion(movement);
        let strokes = motion.strokes().map(|stroke| {
            let (low, high) = self.guard.stroke_mm(stroke.actuator);
            let from_mm = match situation.position(stroke.actuator) {
                Some(Position::At(mm)) => [mm, mm],
                Some(Position::Between { from_mm, to_mm }) => [from_mm, to_mm],
                None => [low, high],
            };
            StrokeView {
                actuator: stroke.actuator.name().into(),
                from_mm,
                to_mm: stroke.to_mm,
            }
        });
        MotionView {
            motion: movement.code().into(),
            strokes: strokes.collect(),
            ..MotionView::default()
        }
    }
}
