//! Where the actuators stand and parts lie at an instant.

/// Names of the actuators, in the order of [`Posture::mm`]: cylinders first, the axis last.
pub const ACTUATORS: [&str; 8] = [
    "escapement",
    "pusher",
    "jaw_left",
    "jaw_right",
    "probe_lift",
    "sort_z",
    "gripper",
    "sort_axis",
];

/// Where everything is at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Posture {
    /// Way of each actuator from rest, mm.
    pub mm: [f64; 8],
    /// A part lies in the pocket.
    pub pocket: bool,
    /// A part is before the pusher, on its way to the nest or back.
    pub pushed: bool,
    /// A part lies in the nest and nobody lifts it.
    pub nest: bool,
    /// The fingers hold a part.
    pub held: bool,
    /// Only springs move, or fingers slide off: a grip gives way without harm.
    pub slack: bool,
}
