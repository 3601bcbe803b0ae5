//! Interlocks of the plant: strokes that need a digital input, as `[actuator]` of `config/rig.toml` declares them.

use super::fault::Fault;
use super::point::DigitalInput;
use super::settings::ActuatorSettings;
use super::stroke::ActuatorKey;
use super::wiring::Wiring;
use crate::guard::{End, Interlock};
use std::collections::BTreeMap;

/// A stroke that needs an input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StrokeNeeds {
    /// The actuator.
    pub actuator: ActuatorKey,
    /// End of its stroke at which the motion arrives.
    pub end: End,
    /// Input that must be on.
    pub input: DigitalInput,
}

impl Wiring {
    /// Returns the interlocks as the guard needs them; their order is that of [`Wiring::interlocks`].
    pub fn guarded(&self) -> Vec<Interlock> {
        let guarded = |needs: &StrokeNeeds| Interlock {
            actuators: needs.actuator.actuators(),
            end: needs.end,
            input: self.input_name(needs.input).to_owned(),
        };
        self.interlocks.iter().map(guarded).collect()
    }
}

/// Resolves the inputs that strokes need; `input` finds one by name.
pub(super) fn resolve_interlocks(
    actuators: &BTreeMap<String, ActuatorSettings>,
    input: impl Fn(&str) -> Option<DigitalInput>,
) -> Result<Vec<StrokeNeeds>, Fault> {
    let mut interlocks = Vec::new();
    for actuator in ActuatorKey::ALL.iter().copied() {
        let Some(settings) = actuators.get(actuator.name()) else {
            continue;
        };
        let ends = [
            ("to_rest_needs", End::Rest, &settings.to_rest_needs),
            ("to_end_needs", End::Far, &settings.to_end_needs),
        ];
        for (key, end, name) in ends {
            let Some(name) = name else { continue };
            let key = format!("actuator.{}.{key}", actuator.name());
            let found = format!("\"{name}\"");
            if actuator == ActuatorKey::Axis {
                let expected = "nothing, because the axis stops at many places";
                return Err(Fault::new(key, found, expected));
            }
            let Some(input) = input(name) else {
                return Err(Fault::new(key, found, "an input of [digital_in]"));
            };
            interlocks.push(StrokeNeeds {
                actuator,
                end,
                input,
            });
        }
    }
    Ok(interlocks)
}
