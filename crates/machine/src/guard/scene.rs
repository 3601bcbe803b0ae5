//! The resolved scene: every body with its shape, its rest pose and the actuators it rides on.

use super::actuator::{Actuator, Position};
use super::error::GuardError;
use super::occupancy::{Offsets, scaled, sum};
use super::part::Role;
use super::rules::Rules;
use super::settings::Policy;
use super::situation::Situation;
use lpm::{Mover, Pose, Shape};

/// The axis of an actuator: direction and range of its stroke.
#[derive(Debug, Clone)]
pub(super) struct Axis {
    /// Unit vector of the stroke.
    pub direction: [f64; 3],
    /// Low and high end of the stroke, mm; the stroke includes 0.
    pub stroke_mm: (f64, f64),
    /// Least distance from an end at which its sensor goes off, mm; at most half the stroke.
    pub sensor_off_mm: f64,
    pub rides: Option<Actuator>,
    pub to_rest: String,
    pub to_end: String,
}

/// An actuator that carries a body, with the direction in which it moves this body (an opposed finger moves against the
/// axis).
#[derive(Debug, Clone, Copy)]
pub(super) struct Ride {
    pub actuator: Actuator,
    pub direction: [f64; 3],
}

/// A fixed element or a piece of tooling.
#[derive(Debug, Clone)]
pub(super) struct Body {
    pub id: String,
    pub shape: Shape,
    /// The shape, decomposed in advance so that sweeps use its true form.
    pub mover: Mover,
    /// Pose with all actuators at rest.
    pub pose: Pose,
    /// Actuators that carry the body; empty for a fixed element.
    pub rides: Vec<Ride>,
}

/// The whole scene. Bodies are numbered: elements in the order of the file, then the roles of the
/// part.
#[derive(Debug, Clone)]
pub(super) struct Scene {
    pub policy: Policy,
    pub bodies: Vec<Body>,
    /// Actuators that carry the part, by [`Role::index`].
    pub part_rides: [Vec<Ride>; 5],
    pub axes: [Axis; 8],
    pub rules: Rules,
}

impl Scene {
    pub fn axis(&self, actuator: Actuator) -> &Axis {
        &self.axes[actuator.index()]
    }

    /// Returns the number of elements and roles of the part together.
    pub fn count(&self) -> usize {
        self.bodies.len() + Role::ALL.len()
    }

    pub fn number_of(&self, role: Role) -> usize {
        self.bodies.len() + role.index()
    }

    pub fn id(&self, number: usize) -> &str {
        match self.bodies.get(number) {
            Some(body) => &body.id,
            None => Role::ALL[number - self.bodies.len()].id(),
        }
    }

    /// Returns the carriers of the element or the role of the part with this number, the nearest first.
    pub fn rides(&self, number: usize) -> &[Ride] {
        match self.bodies.get(number) {
            Some(body) => &body.rides,
            None => &self.part_rides[number - self.bodies.len()],
        }
    }

    /// Returns the pose of a part in `role` with all actuators at rest.
    pub fn part_pose(&self, role: Role) -> Pose {
        let policy = &self.policy;
        Pose::at(match role {
            Role::Feed => policy.mouth,
            Role::Pocket | Role::Pusher => policy.pocket,
            Role::Nest => policy.nest,
            Role::Gripper => {
                let lift = self.axis(Actuator::SortZ);
                sum(policy.nest, scaled(lift.direction, -lift.stroke_mm.1))
            }
        })
    }

    /// Returns the vector from the magazine's mouth to the pocket.
    pub fn feed_way(&self) -> [f64; 3] {
        sum(self.policy.pocket, scaled(self.policy.mouth, -1.0))
    }

    /// Returns the low and high end of `actuator`'s possible positions, mm: its whole stroke when unknown.
    pub fn span_mm(&self, actuator: Actuator, situation: &Situation) -> (f64, f64) {
        situation
            .position(actuator)
            .map_or(self.axis(actuator).stroke_mm, Position::span_mm)
    }

    /// Returns the offsets from the rest pose that `rides` allow, without the actuator `except`.
    pub fn offsets(
        &self,
        rides: &[Ride],
        situation: &Situation,
        except: Option<Actuator>,
    ) -> Offsets {
        rides
            .iter()
            .filter(|ride| Some(ride.actuator) != except)
            .fold(Offsets::NONE, |known, ride| {
                let (low, high) = self.span_mm(ride.actuator, situation);
                known.plus(Offsets::along(ride.direction, low, high))
            })
    }
}

/// Returns `actuator` and every actuator that carries it.
///
/// # Errors
/// Fails with [`GuardError::Circle`] when an actuator rides on itself.
pub(super) fn carriers(axes: &[Axis; 8], actuator: Actuator) -> Result<Vec<Ride>, GuardError> {
    let mut rides = Vec::new();
    let mut next = Some(actuator);
    while let Some(carrier) = next {
        if rides.len() == axes.len() {
            return Err(GuardError::Circle { actuator });
        }
        let axis = &axes[carrier.index()];
        rides.push(Ride {
            actuator: carrier,
            direction: axis.direction,
        });
        next = axis.rides;
    }
    Ok(rides)
}
