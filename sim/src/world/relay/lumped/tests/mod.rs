//! Tests of the five-state model. Other programs computed the expected figures from the same equations with many
//! digits, each at two tolerances.
#![allow(clippy::unwrap_used)]

mod hard;
mod statics;
mod steps;
mod twin;

use super::*;

/// Relative tolerance that keeps events to 1e-11 s.
const FINE: f64 = 1e-10;

fn relay(changed: &[(&str, f64)]) -> Model {
    let mut parameters = Parameters::default();
    for (name, value) in changed {
        assert!(parameters.set(name, *value), "{name}");
    }
    Model::new(&parameters)
}

fn step(volts: f64) -> Excitation {
    ramp(&[[0.0, volts]])
}

fn ramp(points: &[[f64; 2]]) -> Excitation {
    Excitation::Source(Waveform::new(points.to_vec()).unwrap())
}

/// Integrates from rest under an excitation.
fn from_rest(model: &Model, excitation: &Excitation, end_s: f64) -> Transient {
    model
        .transient(model.at_rest(0.0), excitation, end_s, FINE)
        .unwrap()
}

fn outcome(model: &Model, excitation: &Excitation, end_s: f64) -> Outcome {
    Outcome::of(&from_rest(model, excitation, end_s).events)
}

/// Integrates from 12 V, switched off into a suppression.
fn switched_off(model: &Model, suppression_v: f64, end_s: f64) -> Transient {
    model
        .transient(
            model.sealed(12.0),
            &Excitation::Suppression(suppression_v),
            end_s,
            FINE,
        )
        .unwrap()
}

#[track_caller]
fn near(found: Option<f64>, expected: f64, within: f64) {
    let found = found.unwrap_or(f64::NAN);
    assert!(
        (found - expected).abs() <= within,
        "found {found}, expected {expected} within {within}"
    );
}
