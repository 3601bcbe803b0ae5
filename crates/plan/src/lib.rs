//! Interference tables of an assembly, and the order in which its elements come off and go on.
//!
//! [`Assembly`] holds elements at their places. [`Interference`] lists what each element meets on its way out of the
//! space Omega, in each of six directions. From this table [`Planner`] makes a [`Sequence`] that takes the assembly
//! apart, or names the elements that lock each other. [`verified`] moves every step through the collision core with
//! everything else in place. Lengths are in millimetres. The library has no clock, no file and no settings of its own.
//!
//! ```
//! use lpm::{Pose, Shape};
//! use plan::{Assembly, Demands, Element, Outcome, Planner, Tolerance, verified};
//!
//! let block = |id: &str, half, position| Element {
//!     id: id.to_owned(),
//!     shape: Shape::Block { half },
//!     pose: Pose::at(position),
//! };
//! let elements = vec![
//!     block("plate", [20.0, 20.0, 2.0], [0.0, 0.0, 2.0]),
//!     block("relay", [5.0, 5.0, 5.0], [0.0, 0.0, 9.0]),
//!     block("cover", [5.0, 5.0, 1.0], [0.0, 0.0, 15.0]),
//! ];
//! let assembly = Assembly::new(elements, None, Tolerance::default(), Vec::new())?;
//! let demands = Demands {
//!     remove: vec!["relay".to_owned()],
//!     stay: vec!["plate".to_owned()],
//!     forbidden: ["+x", "-x", "+y", "-y"].map(|it| it.parse().unwrap()).to_vec(),
//!     ..Demands::default()
//! };
//! let Outcome::Sequence(sequence) = Planner::new(&assembly, Vec::new())?.disassembly(&demands)? else {
//!     panic!("locked")
//! };
//! let names: Vec<&str> = sequence.steps.iter().map(|step| assembly.id(step.elements[0])).collect();
//! assert_eq!(names, ["cover", "relay"]);
//! assert!(verified(&assembly, &sequence.steps)?.is_ok());
//! # Ok::<(), plan::PlanError>(())
//! ```
//!
//! # Files
//! *The paper* is the published method that the library improves: extruded boxes, and the direction that frees most
//! first.
//!
//! | files | what they hold |
//! |---|---|
//! | `assembly`, `extent`, `thinned` | elements, their boxes, their bodies with the contact depth taken off |
//! | `table` | the global table by sweeps, by boxes of the paper, and the local table |
//! | `mates` | mates: plane on plane, aligned planes, common axis |
//! | `demands`, `ways`, `problem` | what stays and goes, ways of each unit, the combinatorial problem |
//! | `remaining` | the dynamic table: blockers left in each way as units leave |
//! | `greedy` | the rule of the paper |
//! | `batches`, `shortest`, `improve` | fewest changes of direction; shortest ways for few and for many units |
//! | `locked`, `joint`, `only` | locked sets, subassemblies, the fewest elements that must come off |
//! | `planner`, `sequence`, `changeover`, `verify` | plans, their reverse, changes from one scene to another, verification |
//!
//! # Contact
//! The collision core counts touching as contact, so a part that lies on another one could never slide along it. Here
//! two elements block each other only where they press into each other by more than [`Tolerance::contact_mm`], and this
//! holds for every pair and every step. Half of the depth is taken off each body, so a pair blocks alike whichever of
//! the two moves.
//!
//! # Why an order needs no second sweep
//! What blocks a way depends on bodies and places alone, so it is found once. A way is free when all its blockers have
//! left. Leaving frees others and blocks none; so an order exists exactly when removing whatever is free, again and
//! again, removes everything. What is left over is the largest locked set.
//!
//! # Cost
//! [`Cost`]: fewest changes of direction between consecutive legs, then shortest ways. A way ends when the box of what
//! moves has left Omega. Up to 16 units the order is the best one; for more, changes are the fewest unless
//! [`Sequence::is_fewest_changes`] says otherwise, and ways are shortened as long as one unit at a time can be moved to
//! another run.

mod assembly;
mod batches;
mod changeover;
mod demands;
mod direction;
mod error;
mod extent;
#[cfg(any(test, feature = "fixture"))]
pub mod fixture;
mod greedy;
mod improve;
mod joint;
mod locked;
mod mates;
mod only;
mod planner;
mod problem;
mod remaining;
mod sequence;
mod shortest;
mod table;
#[cfg(test)]
mod tests;
mod thinned;
mod verify;
mod ways;

pub use assembly::{Assembly, Element, Guided, Tolerance};
pub use changeover::{Changeover, Planned, changeover};
pub use demands::Demands;
pub use direction::{Direction, UnknownDirection};
pub use error::PlanError;
pub use extent::Extent;
pub use greedy::{Greedy, greedy};
pub use locked::{Locked, is_locked, locked, locked_around};
pub use mates::{Kind, Mate, MateWanted, checked, mates, priority};
pub use only::{Fewest, fewest};
pub use planner::{LockedElements, Ordered, Outcome, Planner, ordered};
pub use problem::{Cost, Leg, Problem, Taken, Way};
pub use remaining::Remaining;
pub use sequence::{Method, Sequence, Step};
pub use table::Interference;
pub use verify::{RANGE_MM, Refused, Verified, verified};

/// Makes `cargo test` compile the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
