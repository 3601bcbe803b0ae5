//! What the station wants to move, and the proof that it may.

use super::actuator::Actuator;

/// One actuator's way: from where it stands to `to_mm` of its stroke.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// Who moves.
    pub actuator: Actuator,
    /// Where to, in mm from the rest end.
    pub to_mm: f64,
}

/// A wanted motion of one actuator, or of several that one valve drives together (the two jaws).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    targets: [Option<f64>; 8],
}

impl Motion {
    /// One actuator to `to_mm` of its stroke.
    pub fn to(actuator: Actuator, to_mm: f64) -> Motion {
        Motion::group(&[Stroke { actuator, to_mm }])
    }

    /// Several actuators at once, in no known order and at no known pace. Of two strokes of the
    /// same actuator the later one counts.
    pub fn group(strokes: &[Stroke]) -> Motion {
        let mut targets = [None; 8];
        for stroke in strokes {
            targets[stroke.actuator.index()] = Some(stroke.to_mm);
        }
        Motion { targets }
    }

    /// The strokes, in the order of [`Actuator::ALL`].
    pub fn strokes(&self) -> impl Iterator<Item = Stroke> + '_ {
        Actuator::ALL.into_iter().filter_map(|actuator| {
            self.target_mm(actuator)
                .map(|to_mm| Stroke { actuator, to_mm })
        })
    }

    /// Where this motion brings `actuator`, in mm; `None` when it leaves it alone.
    pub fn target_mm(&self, actuator: Actuator) -> Option<f64> {
        self.targets[actuator.index()]
    }
}

/// A motion that the guard has cleared for the situation it was asked in. Only
/// [`Guard::clear`](super::Guard::clear) makes one, and it is used up by driving it.
#[derive(Debug, PartialEq)]
pub struct Cleared {
    motion: Motion,
}

impl Cleared {
    pub(super) fn new(motion: Motion) -> Cleared {
        Cleared { motion }
    }

    /// The motion that may be driven.
    pub fn motion(&self) -> &Motion {
        &self.motion
    }
}
