//! Errors of an assembly or a demand.

use crate::extent::Extent;

/// A mistake in the input; the text names what was found and what was expected.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PlanError {
    /// A tolerance is out of its range.
    #[error("tolerance {key}: found {found}, expected {expected}")]
    Tolerance {
        /// Name of the tolerance.
        key: &'static str,
        /// Value found, mm.
        found: f64,
        /// Range expected.
        expected: &'static str,
    },
    /// Two elements have one id.
    #[error("element {found:?}: found twice, expected a name that no other element has")]
    RepeatedId {
        /// The id.
        found: String,
    },
    /// The collision core refuses a body or its pose.
    #[error("element {id:?}: {flaw}")]
    Flawed {
        /// Id of the element.
        id: String,
        /// Flaw of its body or pose.
        flaw: lpm::Flaw,
    },
    /// An element reaches out of the space in which the plan is made.
    #[error(
        "element {id:?}: found {}, expected inside Omega {}",
        corners(found),
        corners(omega)
    )]
    OutsideOmega {
        /// Id of the element.
        id: String,
        /// Box of the element.
        found: Extent,
        /// The space.
        omega: Extent,
    },
    /// Omega is larger than the collision core can cross.
    #[error("Omega: found a size of {found_mm} mm, expected at most {most_mm} mm along each axis")]
    OmegaTooLarge {
        /// Size found, mm.
        found_mm: f64,
        /// Largest size, mm.
        most_mm: f64,
    },
    /// Two elements overlap where they stand.
    #[error(
        "elements {a:?} and {b:?}: found overlapping by more than {allowed_mm} mm, expected apart or in contact"
    )]
    Overlap {
        /// Id of one element.
        a: String,
        /// Id of the other element.
        b: String,
        /// Depth of contact that is allowed, mm.
        allowed_mm: f64,
    },
    /// The collision core cannot decide the way of an element.
    #[error(
        "element {id:?}: found a way that cannot be decided, expected coordinates within 1e6 mm"
    )]
    Undecidable {
        /// Id of the element.
        id: String,
    },
    /// A demand names an element that the assembly does not have.
    #[error("{demand}: found {found:?}, expected the id of an element")]
    UnknownId {
        /// Name of the demand.
        demand: &'static str,
        /// Id found.
        found: String,
    },
    /// Two demands about one element contradict each other.
    #[error("element {id:?}: found in both {first} and {second}, expected in one of them")]
    Contradiction {
        /// Id of the element.
        id: String,
        /// One demand.
        first: &'static str,
        /// The other demand.
        second: &'static str,
    },
    /// Every direction is forbidden.
    #[error("forbid: found all six directions, expected at least one that is left")]
    NoDirection,
    /// A mate names two elements that do not fit it.
    #[error("mate of {a:?} and {b:?}: found {found}, expected {expected}")]
    Mate {
        /// Id of one element.
        a: String,
        /// Id of the other element.
        b: String,
        /// What was found.
        found: String,
        /// What was expected.
        expected: &'static str,
    },
}

/// Writes the corners of a box, mm, to 1e-5 mm: without the rounding of boxes outward, but finer than any contact depth
/// in use.
fn corners(extent: &Extent) -> String {
    let rounded = |corner: [f64; 3]| corner.map(|mm| (mm * 1e5).round() / 1e5 + 0.0);
    format!(
        "from {:?} to {:?} mm",
        rounded(extent.low),
        rounded(extent.high)
    )
}
