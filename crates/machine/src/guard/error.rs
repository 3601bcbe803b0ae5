//! Reasons for which the guard rejects a scene.

use super::actuator::Actuator;
use super::refusal::Refusal;
use lpm::Flaw;

/// An error in `scene.toml`; `path` is the place in the file.
#[derive(Debug, Clone, thiserror::Error)]
pub enum GuardError {
    /// A number out of range.
    #[error("{path}: found {found}, expected {expected}")]
    Number {
        /// Place in the file.
        path: String,
        /// Number found.
        found: f64,
        /// Range expected.
        expected: &'static str,
    },
    /// A unit other than mm.
    #[error("units: found \"{found}\", expected \"mm\"")]
    Unit {
        /// Unit found.
        found: String,
    },
    /// A body that lacks a key of its kind, or has a key of another kind.
    #[error("{path}: a {kind} needs {expected} and no other size")]
    Member {
        /// Place in the file.
        path: String,
        /// `block`, `cylinder` or `compound`.
        kind: &'static str,
        /// The keys that the kind needs.
        expected: &'static str,
    },
    /// A size or pose that makes no valid body.
    #[error("{path}: not a body")]
    Body {
        /// Place in the file.
        path: String,
        /// Defect of the body.
        #[source]
        flaw: Flaw,
    },
    /// Two bodies with one id, or an id that a role of the part has.
    #[error("{path}: the id \"{id}\" is taken, expected one of its own")]
    Duplicate {
        /// Place in the file.
        path: String,
        /// The id.
        id: String,
    },
    /// An id that no body has.
    #[error("{path}: no body is called \"{found}\"")]
    UnknownBody {
        /// Place in the file.
        path: String,
        /// The id.
        found: String,
    },
    /// An actuator that the file does not describe exactly once.
    #[error("actuator: {actuator} is described {times} times, expected once")]
    ActuatorCount {
        /// The actuator.
        actuator: Actuator,
        /// Number of descriptions.
        times: usize,
    },
    /// The keys `rides` form a cycle: an actuator rides on itself, perhaps through others.
    #[error("actuator {actuator}: rides on itself through others")]
    Circle {
        /// An actuator of this cycle.
        actuator: Actuator,
    },
    /// In the empty rig at rest an actuator cannot make its stroke.
    #[error("actuator {actuator}: its own stroke is not free in an empty rig")]
    StrokeBlocked {
        /// The actuator.
        actuator: Actuator,
        /// The refusal of its stroke.
        #[source]
        refusal: Box<Refusal>,
    },
}
