//! The motion that the station requests, and the proof that it is clear.

use super::actuator::Actuator;

/// One actuator's way to `to_mm` of its stroke.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// The actuator that moves.
    pub actuator: Actuator,
    /// Target, mm from the rest end.
    pub to_mm: f64,
}

/// A motion of one actuator, or of several that one valve drives together (the two jaws).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    targets: [Option<f64>; 8],
}

impl Motion {
    /// Makes a motion of one actuator to `to_mm` of its stroke.
    pub fn to(actuator: Actuator, to_mm: f64) -> Motion {
        Motion::group(&[Stroke { actuator, to_mm }])
    }

    /// Makes a motion of several actuators at once, in unknown order and at unknown speed. Of two strokes of the same
    /// actuator the later one counts.
    pub fn group(strokes: &[Stroke]) -> Motion {
        let mut targets = [None; 8];
        for stroke in strokes {
            targets[stroke.actuator.index()] = Some(stroke.to_mm);
        }
        Motion { targets }
    }

    /// Yields the strokes in the order of [`Actuator::ALL`].
    pub fn strokes(&self) -> impl Iterator<Item = Stroke> + '_ {
        Actuator::ALL.into_iter().filter_map(|actuator| {
            self.target_mm(actuator)
                .map(|to_mm| Stroke { actuator, to_mm })
        })
    }

    /// Returns the target of `actuator`, mm; `None` when it does not move.
    pub fn target_mm(&self, actuator: Actuator) -> Option<f64> {
        self.targets[actuator.index()]
    }
}

/// A motion that the guard cleared for one situation. Only [`Guard::clear`](super::Guard::clear) makes one, and
/// driving it consumes it.
#[derive(Debug, PartialEq)]
pub struct Cleared {
    motion: Motion,
}

impl Cleared {
    pub(super) fn new(motion: Motion) -> Cleared {
        Cleared { motion }
    }

    /// Returns the cleared motion.
    pub fn motion(&self) -> &Motion {
        &self.motion
    }
}
