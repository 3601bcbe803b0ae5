//! The part as a body: its shape from the recipe, and its five roles in the space.
//!
//! The shape is the body's block and, below it, one block around all pins (at least `pin_inset_mm` inside the
//! outline), so that the guard needs no drawing of a recipe's pins. The origin of its frame is the middle of the lower
//! rear (-x) edge of the body, which the pusher and the track locate.

use super::settings::Policy;
use super::situation::PartSize;
use lpm::{Pose, Shape};

/// Place of the part; each role has its own body id because the place decides what may touch it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    /// Released by the escapement, on its way into the pocket.
    Feed,
    /// Waiting in the pocket.
    Pocket,
    /// Pushed towards the nest.
    Pusher,
    /// In the nest.
    Nest,
    /// In the gripper.
    Gripper,
}

impl Role {
    pub const ALL: [Role; 5] = [
        Role::Feed,
        Role::Pocket,
        Role::Pusher,
        Role::Nest,
        Role::Gripper,
    ];

    pub const fn id(self) -> &'static str {
        match self {
            Role::Feed => "part_feed",
            Role::Pocket => "part_pocket",
            Role::Pusher => "part_pusher",
            Role::Nest => "part_nest",
            Role::Gripper => "part_gripper",
        }
    }

    pub const fn index(self) -> usize {
        self as usize
    }
}

/// Returns the shape of a part of this size, body and pins.
pub(super) fn shape_of(size: &PartSize, policy: &Policy) -> Shape {
    let [x, y, z] = size.body_mm;
    let body = (
        Pose::at([x / 2.0, 0.0, z / 2.0]),
        Shape::Block {
            half: [x / 2.0, y / 2.0, z / 2.0],
        },
    );
    let pins = size.pin_length_mm / 2.0;
    let [pins_x, pins_y] = [x / 2.0 - policy.pin_inset_mm, y / 2.0 - policy.pin_inset_mm];
    if pins <= 0.0 || pins_x <= 0.0 || pins_y <= 0.0 {
        return Shape::Compound(vec![body]);
    }
    let pins = (
        Pose::at([x / 2.0, 0.0, -pins]),
        Shape::Block {
            half: [pins_x, pins_y, pins],
        },
    );
    Shape::Compound(vec![body, pins])
}
