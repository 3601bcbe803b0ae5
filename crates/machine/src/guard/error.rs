//! Why a scene cannot be guarded.

use super::actuator::Actuator;
use super::refusal::Refusal;
use lpm::Flaw;

/// What is wrong with `scene.toml`; `path` is the place in the file.
#[derive(Debug, Clone, thiserror::Error)]
pub enum GuardError {
    /// A number out of range.
    #[error("{path}: found {found}, expected {expected}")]
    Number {
        /// Place in the file.
        path: String,
        /// What stands there.
        found: f64,
        /// What may stand there.
        expected: &'static str,
    },
    /// Lengths in another unit.
    #[error("units: found \"{found}\", expected \"mm\"")]
    Unit {
        /// What stands there.
        found: String,
    },
    /// A body without the member that its kind needs, or with one it does not have.
    #[error("{path}: a {kind} needs {expected} and no other size")]
    Member {
        /// Place in the file.
        path: String,
        /// `block`, `cylinder` or `compound`.
        kind: &'static str,
        /// The missing member.
        expected: &'static str,
    },
    /// A size or pose that is no body.
    #[error("{path}: not a body")]
    Body {
        /// Place in the file.
        path: String,
        /// What is wrong with it.
        #[source]
        flaw: Flaw,
    },
    /// Two bodies of one name, or the name of a part's role.
    #[error("{path}: the id \"{id}\" is taken, expected one of its own")]
    Duplicate {
        /// Place in the file.
        path: String,
        /// The name.
        id: String,
    },
    /// A name that no body has.
    #[error("{path}: no body is called \"{found}\"")]
    UnknownBody {
        /// Place in the file.
        path: String,
        /// The name.
        found: String,
    },
    /// Not every actuator is there exactly once.
    #[error("actuator: {actuator} is described {times} times, expected once")]
    ActuatorCount {
        /// Which.
        actuator: Actuator,
        /// How often.
        times: usize,
    },
    /// `rides` goes round in a circle.
    #[error("actuator {actuator}: rides on itself through others")]
    Circle {
        /// Where it was noticed.
        actuator: Actuator,
    },
    /// With everything else at rest and no part anywhere, an actuator cannot make its stroke.
    #[error("actuator {actuator}: its own stroke is not free in an empty rig")]
    StrokeBlocked {
        /// Which.
        actuator: Actuator,
        /// By what.
        #[source]
        refusal: Box<Refusal>,
    },
}
