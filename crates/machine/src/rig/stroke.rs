//! Actuators by their keys in `config/rig.toml`, and the longest time of each stroke.

use super::fault::Fault;
use super::settings::ActuatorSettings;
use crate::guard::Actuator;
use std::collections::BTreeMap;
use units::Span;

named! {
    /// Actuator that a time-out, a retry or an alarm concerns; both jaws count as one, the clamp.
    ActuatorKey {
        /// Escapement between track and pocket.
        Escapement = "escapement",
        /// Pusher from the pocket to the nest.
        Pusher = "pusher",
        /// Both jaws.
        Clamp = "clamp",
        /// Lift of the probes.
        ProbeLift = "probe_lift",
        /// Gripper up and down.
        SortZ = "sort_z",
        /// Fingers.
        Gripper = "gripper",
        /// Sort axis.
        Axis = "axis",
    }
}

impl ActuatorKey {
    /// Returns the actuators that the valve of this stroke drives.
    pub const fn actuators(self) -> &'static [Actuator] {
        match self {
            ActuatorKey::Escapement => &[Actuator::Escapement],
            ActuatorKey::Pusher => &[Actuator::Pusher],
            ActuatorKey::Clamp => &[Actuator::JawLeft, Actuator::JawRight],
            ActuatorKey::ProbeLift => &[Actuator::ProbeLift],
            ActuatorKey::SortZ => &[Actuator::SortZ],
            ActuatorKey::Gripper => &[Actuator::Gripper],
            ActuatorKey::Axis => &[Actuator::SortAxis],
        }
    }
}

/// Longest time of each stroke, in the order of [`ActuatorKey::ALL`].
pub type StrokeLimits = [Span; ActuatorKey::COUNT];

pub(super) fn resolve_strokes(
    actuators: &BTreeMap<String, ActuatorSettings>,
) -> Result<StrokeLimits, Fault> {
    let mut limits = StrokeLimits::default();
    for (limit, name) in limits.iter_mut().zip(ActuatorKey::NAMES) {
        let Some(settings) = actuators.get(*name) else {
            return Err(Fault::new(
                format!("actuator.{name}"),
                "nothing",
                "a time-out",
            ));
        };
        *limit = Span::seconds(settings.timeout_ms / 1000.0);
    }
    Ok(limits)
}
