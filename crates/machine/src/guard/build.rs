//! Builds the scene from the settings, and rejects settings with which a decision of the guard would mean nothing.

use super::axes::axes_of;
use super::bodies::{bodies_of, part_rides};
use super::error::GuardError;
use super::part::Role;
use super::rules::Rules;
use super::scene::Scene;
use super::settings::{GuardSettings, Policy};

/// Checks the settings and returns the scene that they describe.
pub(super) fn scene_of(settings: &GuardSettings) -> Result<Scene, GuardError> {
    if let Some(unit) = settings.units.as_ref().filter(|unit| *unit != "mm") {
        return Err(GuardError::Unit {
            found: unit.clone(),
        });
    }
    check_policy(&settings.guard)?;
    let axes = axes_of(&settings.actuator)?;
    let bodies = bodies_of(settings, &axes)?;
    let parts = Role::ALL.into_iter().map(|role| role.id().to_owned());
    let ids: Vec<String> = bodies
        .iter()
        .map(|body| body.id.clone())
        .chain(parts)
        .collect();
    check_names(&ids, settings)?;
    let rules = Rules::of(settings, &ids)?;
    let part_rides = part_rides(&axes)?;
    Ok(Scene {
        policy: settings.guard.clone(),
        bodies,
        part_rides,
        axes,
        rules,
    })
}

fn check_policy(policy: &Policy) -> Result<(), GuardError> {
    let sizes = [
        ("default_margin_mm", policy.default_margin_mm),
        ("touch_depth_mm", policy.touch_depth_mm),
        ("pin_inset_mm", policy.pin_inset_mm),
    ];
    for (key, found) in sizes {
        if !(found.is_finite() && found >= 0.0) {
            return Err(GuardError::Number {
                path: format!("guard.{key}"),
                found,
                expected: ">= 0",
            });
        }
    }
    for (key, place) in [
        ("mouth", policy.mouth),
        ("pocket", policy.pocket),
        ("nest", policy.nest),
    ] {
        finite(&format!("guard.{key}"), &place)?;
    }
    Ok(())
}

/// Rejects the first of `numbers` that is NaN or infinite.
pub(super) fn finite(path: &str, numbers: &[f64]) -> Result<(), GuardError> {
    match numbers.iter().position(|number| !number.is_finite()) {
        None => Ok(()),
        Some(i) => Err(GuardError::Number {
            path: format!("{path}[{i}]"),
            found: numbers[i],
            expected: "a finite number",
        }),
    }
}

fn check_names(ids: &[String], settings: &GuardSettings) -> Result<(), GuardError> {
    for (index, id) in ids.iter().enumerate() {
        if let Some(first) = ids[..index].iter().position(|earlier| earlier == id) {
            // The error names the later of two elements with one id, or the element that has the id of a role of the
            // part.
            let blamed = if index < settings.elements.len() {
                index
            } else {
                first
            };
            return Err(GuardError::Duplicate {
                path: format!("elements[{blamed}]"),
                id: id.clone(),
            });
        }
    }
    for axis in &settings.actuator {
        let rides = |id: &str| {
            settings
                .elements
                .iter()
                .any(|e| e.id == id && e.rides == Some(axis.id))
        };
        if let Some(found) = axis.opposed.iter().find(|id| !rides(id)) {
            let path = format!("actuator {}.opposed", axis.id);
            return Err(GuardError::UnknownBody {
                path,
                found: found.clone(),
            });
        }
    }
    Ok(())
}
