//! The guard's decision on a motion, shown before a jog or after a refusal.

use serde::Serialize;
use utoipa::ToSchema;

/// One motion of tooling.
#[derive(Debug, Clone, Default, PartialEq, Serialize, ToSchema)]
pub struct MotionView {
    /// Name in the order `jog`, or name of a motion of the sequence.
    pub motion: String,
    /// Strokes of the actuators involved.
    pub strokes: Vec<StrokeView>,
    /// Least distance to the bodies that the motion must not touch, mm; null above 25 mm, and for a refused motion.
    pub clearance_mm: Option<f64>,
    /// Reason for the refusal; null when the motion is clear.
    pub refused: Option<RefusedView>,
}

/// Stroke of one actuator.
#[derive(Debug, Clone, Default, PartialEq, Serialize, ToSchema)]
pub struct StrokeView {
    /// Name as in `config/scene.toml`.
    pub actuator: String,
    /// Lowest and highest possible position at the start, mm from the rest end.
    pub from_mm: [f64; 2],
    /// Target, mm.
    pub to_mm: f64,
}

/// Reason why the guard refuses the motion.
#[derive(Debug, Clone, Default, PartialEq, Serialize, ToSchema)]
pub struct RefusedView {
    /// Body that would move; empty when the motion itself is invalid.
    pub mover: String,
    /// Body in its way; empty when the motion itself is invalid.
    pub blocker: String,
    /// Least distance between the two bodies during the motion, mm.
    pub distance_mm: f64,
    /// Least distance required, mm.
    pub margin_mm: f64,
    /// Place of the contact, mm.
    pub at: [f64; 3],
    /// Position up to which the stroke is clear, mm from the rest end; an actuator that has moved beyond it may return
    /// to it. Null when the stroke is blocked at its start.
    pub last_clear_mm: Option<f64>,
    /// English text of the refusal, with the remedy.
    pub text: String,
    /// Chinese text of the refusal.
    pub text_zh: String,
}
