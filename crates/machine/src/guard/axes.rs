//! The actuators' axes from the settings; checks that each occurs once, with a unit direction and a stroke.

use super::actuator::Actuator;
use super::build::finite;
use super::error::GuardError;
use super::scene::{Axis, carriers};
use super::settings::ActuatorSettings;

/// Greatest deviation of an axis vector from length 1; people type its components with three decimals.
const UNIT_TOLERANCE: f64 = 1e-3;

/// Returns the axes by [`Actuator::index`].
pub(super) fn axes_of(settings: &[ActuatorSettings]) -> Result<[Axis; 8], GuardError> {
    let mut axes = Vec::with_capacity(Actuator::ALL.len());
    for actuator in Actuator::ALL {
        let mut found = settings.iter().filter(|axis| axis.id == actuator);
        match (found.next(), found.count()) {
            (Some(axis), 0) => axes.push(axis_of(axis)?),
            (None, _) => return Err(GuardError::ActuatorCount { actuator, times: 0 }),
            (Some(_), more) => {
                return Err(GuardError::ActuatorCount {
                    actuator,
                    times: 1 + more,
                });
            }
        }
    }
    let axes: [Axis; 8] = axes.try_into().map_err(|_| GuardError::ActuatorCount {
        actuator: Actuator::Escapement,
        times: 0,
    })?;
    for actuator in Actuator::ALL {
        carriers(&axes, actuator)?;
    }
    Ok(axes)
}

fn axis_of(settings: &ActuatorSettings) -> Result<Axis, GuardError> {
    let path = |key: &str| format!("actuator {}.{key}", settings.id);
    let [x, y, z] = settings.axis;
    let length = (x * x + y * y + z * z).sqrt();
    if !(1.0 - UNIT_TOLERANCE..=1.0 + UNIT_TOLERANCE).contains(&length) {
        return Err(GuardError::Number {
            path: path("axis"),
            found: length,
            expected: "a length of 1",
        });
    }
    let stroke_mm = match (&settings.points_mm, settings.stroke_mm) {
        (None, Some(stroke)) if stroke.is_finite() && stroke > 0.0 => (0.0, stroke),
        (Some(points), None) => span_of(points, &path("points_mm"))?,
        (_, found) => {
            return Err(GuardError::Number {
                path: path("stroke_mm"),
                found: found.unwrap_or(f64::NAN),
                expected: "above 0, or points_mm in its place",
            });
        }
    };
    let half = 0.5 * (stroke_mm.1 - stroke_mm.0);
    if !(0.0..=half).contains(&settings.sensor_off_mm) {
        return Err(GuardError::Number {
            path: path("sensor_off_mm"),
            found: settings.sensor_off_mm,
            expected: "0 to half the stroke",
        });
    }
    Ok(Axis {
        direction: settings.axis.map(|member| member / length),
        stroke_mm,
        sensor_off_mm: settings.sensor_off_mm,
        rides: settings.rides,
        to_rest: words(&settings.to_rest, settings.id, "rest"),
        to_end: words(&settings.to_end, settings.id, "other"),
    })
}

fn words(given: &Option<String>, actuator: Actuator, end: &str) -> String {
    given
        .clone()
        .unwrap_or_else(|| format!("move {actuator} to its {end} end"))
}

fn span_of(points: &[f64], path: &str) -> Result<(f64, f64), GuardError> {
    finite(path, points)?;
    let low = points.iter().copied().fold(f64::INFINITY, f64::min);
    let high = points.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if low > 0.0 || high < 0.0 || low >= high {
        let path = path.to_owned();
        return Err(GuardError::Number {
            path,
            found: low,
            expected: "two points or more around 0",
        });
    }
    Ok((low, high))
}
