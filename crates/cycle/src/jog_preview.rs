//! Asks the guard about motions; shows its decisions on the motions that a person may order next, and the motion that
//! it refused last.

use super::Cycle;
use machine::guard::{Cleared, Motion, Position, Refusal, Situation};
use machine::handling::moves::Move;
use machine::station::orders;
use machine::view::{MotionView, RefusedView, StrokeView};
use texts::Lang;
use units::RigTime;

/// Largest distance between bodies that is shown, mm.
const RANGE_MM: f64 = 25.0;

impl Cycle {
    /// Returns the clearance of the guard for a motion, or its refusal with the situation.
    pub(super) fn judge(
        &mut self,
        movement: Move,
        now: RigTime,
    ) -> Result<Cleared, Box<(Situation, Refusal)>> {
        let motion = self.station.motion(movement);
        let situation = self.station.situation(now, &self.image);
        let (Some(guard), Some(motion), Some(situation)) = (&mut self.guard, motion, situation)
        else {
            panic!("{movement:?} on a rig where nothing moves");
        };
        let cleared = guard.clear(&motion, &situation);
        cleared.map_err(|refusal| Box::new((situation, refusal)))
    }

    /// Returns the guard's decision on every motion that may be jogged now; empty while jogging is not allowed.
    pub(super) fn jog_preview(&mut self, now: RigTime) -> Vec<MotionView> {
        if self.station.may_jog().is_err() {
            return Vec::new();
        }
        let jogs = orders::JOGS.into_iter();
        jogs.filter_map(|movement| self.preview(movement, now))
            .collect()
    }

    /// Returns the guard's decision on one motion; `None` on a rig where nothing moves.
    fn preview(&mut self, movement: Move, now: RigTime) -> Option<MotionView> {
        let situation = self.station.situation(now, &self.image)?;
        let motion = self.station.motion(movement)?;
        let guard = self.guard.as_mut()?;
        let clearance_mm = match guard.clear(&motion, &situation) {
            Ok(_) => guard.clearance_mm(&motion, &situation, RANGE_MM),
            Err(refusal) => return Some(self.refused_motion(movement, &situation, &refusal)),
        };
        Some(MotionView {
            clearance_mm,
            ..self.shown(movement, &situation)
        })
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
            Refusal::OutOfStroke { .. } | Refusal::Interlock { .. } | Refusal::PartSize { .. } => {
                RefusedView {
                    text,
                    text_zh,
                    ..RefusedView::default()
                }
            }
        };
        MotionView {
            refused: Some(refused),
            ..self.shown(movement, situation)
        }
    }

    fn shown(&self, movement: Move, situation: &Situation) -> MotionView {
        let motion = self.station.motion(movement);
        let strokes = motion
            .iter()
            .flat_map(Motion::strokes)
            .filter_map(|stroke| {
                let (low, high) = self.guard.as_ref()?.stroke_mm(stroke.actuator);
                let from_mm = match situation.position(stroke.actuator) {
                    Some(Position::At(mm)) => [mm, mm],
                    Some(Position::Between { from_mm, to_mm }) => [from_mm, to_mm],
                    None => [low, high],
                };
                Some(StrokeView {
                    actuator: stroke.actuator.name().into(),
                    from_mm,
                    to_mm: stroke.to_mm,
                })
            });
        MotionView {
            motion: movement.code().into(),
            strokes: strokes.collect(),
            ..MotionView::default()
        }
    }
}
