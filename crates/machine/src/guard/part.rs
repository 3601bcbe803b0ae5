//! The part as a body: its shape from the recipe and the five roles it plays in the space.
//!
//! The shape is the body's block and, below it, one block around all pins (they stand at least
//! `pin_inset_mm` inside the outline): the pin layout of a recipe needs no drawing. Its frame has
//! the origin in the middle of the lower rear (-x) edge of the body, the edge that the pusher and
//! the track locate.

use super::settings::Policy;
use super::situation::PartSize;
use lpm::{Pose, Shape};

/// Where a part is decides what may touch it, so each role has its own body id.
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

/// Body and pins of a part of this size.
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
