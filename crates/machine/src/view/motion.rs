//! A motion as the guard judged it: for a person, before it is jogged or after it was refused.

use serde::Serialize;

/// One motion of tooling.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct MotionView {
    /// Name as in the order `jog`, or of a motion of the sequence.
    pub motion: String,
    /// Who would go where.
    pub strokes: Vec<StrokeView>,
    /// Least distance on the way to anything that must be kept away from, mm; null beyond 25 mm and when
    /// refused.
    pub clearance_mm: Option<f64>,
    /// Why not; null when it may be driven.
    pub refused: Option<RefusedView>,
}

/// The way of one actuator.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct StrokeView {
    /// Name as in `config/scene.toml`.
    pub actuator: String,
    /// Lowest and highest position it may stand at, mm from its rest end.
    pub from_mm: [f64; 2],
    /// Where to, mm.
    pub to_mm: f64,
}

/// What stands in the way.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct RefusedView {
    /// Body that would move; empty when the motion itself is none.
    pub mover: String,
    /// Body in its way; empty like the mover.
    pub blocker: String,
    /// Least distance the two would have, mm.
    pub distance_mm: f64,
    /// Distance they must exceed, mm.
    pub margin_mm: f64,
    /// Where, mm.
    pub at: [f64; 3],
    /// How far the stroke is clear, mm from its rest end: the pose to go back to. None, if it is blocked where it begins.
    pub last_clear_mm: Option<f64>,
    /// The whole sentence, with what would help.
    pub text: String,
}
