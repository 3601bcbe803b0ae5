//! Positions of actuators and parts at an instant.

/// Names of the actuators in the order of [`Posture::mm`]: cylinders first, the axis last.
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

/// Positions of actuators and parts at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Posture {
    /// Travel of each actuator from rest, mm.
    pub mm: [f64; 8],
    /// True when a part is at rest in the pocket.
    pub pocket: bool,
    /// True when a part is in front of the pusher, on its way to the nest or back.
    pub pushed: bool,
    /// True when a part is in the nest and not lifted.
    pub nest: bool,
    /// True when the fingers hold a part.
    pub held: bool,
    /// True when a grip yields without damage, because only springs move or the fingers slide off.
    pub slack: bool,
}
