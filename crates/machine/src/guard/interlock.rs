//! Inputs that a motion needs: an interlock of the plant, independent of the bodies in the scene.

use super::actuator::Actuator;
use super::motion::Motion;
use super::refusal::Refusal;
use super::situation::Situation;

/// End of a stroke.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// Low end of the stroke.
    Rest,
    /// High end of the stroke.
    Far,
}

/// A stroke that needs an input.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Interlock {
    /// Actuators that one valve drives.
    pub actuators: &'static [Actuator],
    /// End of their strokes at which the motion arrives.
    pub end: End,
    /// Name of the input that must be on.
    pub input: String,
}

impl Interlock {
    /// Returns the actuator that `motion` drives to [`Self::end`]; `None` for any other motion. `stroke_mm` returns the
    /// low and high end of a stroke.
    fn concerns(
        &self,
        motion: &Motion,
        stroke_mm: impl Fn(Actuator) -> (f64, f64),
    ) -> Option<Actuator> {
        let mut own = self.actuators.iter().copied();
        own.find(|actuator| {
            let (low, high) = stroke_mm(*actuator);
            let end = match self.end {
                End::Rest => low,
                End::Far => high,
            };
            motion.target_mm(*actuator) == Some(end)
        })
    }
}

/// Refuses a motion whose input the situation does not grant. The index in `interlocks` is the number in
/// [`Situation::grant`].
pub(super) fn check(
    interlocks: &[Interlock],
    motion: &Motion,
    situation: &Situation,
    stroke_mm: impl Fn(Actuator) -> (f64, f64),
) -> Result<(), Refusal> {
    for (number, interlock) in interlocks.iter().enumerate() {
        let held = interlock.concerns(motion, &stroke_mm);
        if let Some(actuator) = held.filter(|_| !situation.is_granted(number)) {
            return Err(Refusal::Interlock {
                actuator,
                input: interlock.input.clone(),
            });
        }
    }
    Ok(())
}
