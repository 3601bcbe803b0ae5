//! Makes the bodies of the scene from the settings, with their carriers.

use super::actuator::Actuator;
use super::error::GuardError;
use super::part::Role;
use super::scene::{Axis, Body, Ride, carriers};
use super::settings::{GuardSettings, Piece, PoseSettings, ShapeKind};
use lpm::{Mover, Pose, Shape};

/// Returns the bodies in the order of the file.
pub(super) fn bodies_of(
    settings: &GuardSettings,
    axes: &[Axis; 8],
) -> Result<Vec<Body>, GuardError> {
    let opposed = |actuator: Actuator, id: &str| {
        settings
            .actuator
            .iter()
            .any(|axis| axis.id == actuator && axis.opposed.iter().any(|o| o == id))
    };
    let mut bodies = Vec::with_capacity(settings.elements.len());
    for (index, element) in settings.elements.iter().enumerate() {
        let path = format!("elements[{index}]");
        let piece = Piece {
            kind: element.kind,
            half: element.half,
            radius: element.radius,
            height: element.height,
            parts: element.parts.clone(),
            pose: element.pose,
        };
        let (pose, shape) = body_of(&piece, &path)?;
        let flawed = |flaw| GuardError::Body {
            path: path.clone(),
            flaw,
        };
        let mover = Mover::new(&shape).map_err(flawed)?;
        pose.check().map_err(flawed)?;
        let mut rides = element
            .rides
            .map_or(Ok(Vec::new()), |carrier| carriers(axes, carrier))?;
        if let Some(ride) = rides.first_mut()
            && opposed(ride.actuator, &element.id)
        {
            ride.direction = ride.direction.map(|member| -member);
        }
        bodies.push(Body {
            id: element.id.clone(),
            shape,
            mover,
            pose,
            rides,
        });
    }
    Ok(bodies)
}

/// Returns the actuators that carry a part in each role, by [`Role::index`].
pub(super) fn part_rides(axes: &[Axis; 8]) -> Result<[Vec<Ride>; 5], GuardError> {
    let mut rides: [Vec<Ride>; 5] = Default::default();
    for role in Role::ALL {
        rides[role.index()] = match role {
            Role::Feed | Role::Pocket | Role::Nest => Vec::new(),
            Role::Pusher => carriers(axes, Actuator::Pusher)?,
            Role::Gripper => carriers(axes, Actuator::SortZ)?,
        };
    }
    Ok(rides)
}

fn body_of(piece: &Piece, path: &str) -> Result<(Pose, Shape), GuardError> {
    let lacking = |kind, expected| GuardError::Member {
        path: path.to_owned(),
        kind,
        expected,
    };
    let shape = match (
        piece.kind,
        piece.half,
        (piece.radius, piece.height),
        &piece.parts,
    ) {
        (ShapeKind::Block, Some(half), (None, None), None) => Shape::Block { half },
        (ShapeKind::Cylinder, None, (Some(radius), Some(height)), None) => {
            Shape::Cylinder { radius, height }
        }
        (ShapeKind::Compound, None, (None, None), Some(parts)) => {
            let placed = parts
                .iter()
                .enumerate()
                .map(|(i, part)| body_of(part, &format!("{path}.parts[{i}]")));
            Shape::Compound(placed.collect::<Result<_, _>>()?)
        }
        (ShapeKind::Block, _, _, _) => return Err(lacking("block", "half")),
        (ShapeKind::Cylinder, _, _, _) => return Err(lacking("cylinder", "radius and height")),
        (ShapeKind::Compound, _, _, _) => return Err(lacking("compound", "parts")),
    };
    let PoseSettings { position, rotation } = piece.pose;
    Ok((Pose { position, rotation }.rescaled(), shape))
}
