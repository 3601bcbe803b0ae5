//! Collision core: decides whether a rigid body can travel along a path between stationary bodies, and proves every
//! "clear".
//!
//! The library has no clock, no file access and no settings of its own. Lengths are in millimetres, frames are
//! right-handed, z points up. [`Model`] holds the stationary elements. Four questions check a [`Move`] of a [`Mover`]
//! or a [`Shape`] against these elements: [`Model::any_hit`] (is there any contact?), [`Model::every_hit`] (with which
//! elements?), [`Model::first_contact`] and [`Model::clearance`]. [`Model::first_forbidden`] applies a [`Permission`]
//! to each pair of mover and element.
//!
//! ```
//! use lpm::{Model, Move, Pose, Shape};
//!
//! let mut model = Model::new();
//! let block = Shape::Block { half: [10.0, 20.0, 15.0] };
//! let jaw = model.insert("jaw", &block, &Pose::at([100.0, 0.0, 15.0]))?;
//! let gripper = Shape::Cylinder { radius: 8.0, height: 40.0 };
//! let way = Move {
//!     from: Pose::at([0.0, 0.0, 51.0]),
//!     to: Pose::at([200.0, 0.0, 51.0]),
//!     margin_mm: 2.0,
//!     ignore: &[],
//! };
//! assert_eq!(model.any_hit(&gripper, &way), Some(jaw));
//! # Ok::<(), lpm::Flaw>(())
//! ```
//!
//! # Files
//! | files | what they hold |
//! |---|---|
//! | `model`, `stationary`, `name` | the stationary elements, their pieces and their names |
//! | `question`, `answer`, `permission` | the questions, their answers, permissions of pairs |
//! | `shape`, `pose`, `piece`, `prism`, `mover`, `interior` | a body: as given, as convex pieces, as upright prisms, as a mover, its enclosed spaces |
//! | `path`, `passage` | the path of a mover, alone and through a model |
//! | `space`, `candidates` | broad phase: `layers` holds Omega and `{h1, h2}`, `grid` holds `V`, `silhouettes` and `codes` hold `B` |
//! | `rest`, `meeting`, `touch`, `grazing` | upright pieces in closed form: at rest, on a straight path, place of contact, grazing contacts |
//! | `straight`, `turning`, `distance` | any convex pieces: translations, turns, separating planes |
//! | `contact`, `search`, `nearest` | searches for any contact, for the first contact, and for the least distance |
//! | `solid`, `closed` | points inside closed meshes |
//! | [`scene`], `outline` | scene and move files; silhouettes for drawings |
//! | [`exact`] | the true answer in whole numbers, for tests and benchmarks |
//!
//! # The layer-based projection model
//! The broad phase follows Peng and others (2010), sections 3 and 4. A checking space Omega over the baseplate is as
//! high as its elements and is cut into layers `{h1, h2, V, B}`; elements are inserted and removed one by one. The
//! broad phase tests layer, silhouette and oriented box, in this order, and stops at the first miss. The layout of `V`,
//! the choice of layers and everything after the broad phase are this library's own. The library has no separate test
//! of the oriented box: it tests the piece itself, in closed form (`meeting`, `touch`) or by a separating plane
//! (`distance`).
//!
//! # Continuous and exact checks
//! The paper checks poses (`rest`); this library also checks paths. For upright blocks and cylinders on a straight
//! path, a closed form gives the contact (`meeting`). Along a translation the distance of any two convex pieces is a
//! convex function, so a few separating planes give first contact and least distance for the true shapes; cylinders
//! stay round, in any orientation (`straight`). A turning move advances step by step, each step proven by a
//! second-order bound (`turning`).
//!
//! # Never a false clear
//! Bodies are closed sets: touching is contact. *Blocked* means that the distance comes within the margin, or that this
//! could not be excluded. The proof of *clear* has these steps:
//! 1. A pair of upright pieces on a straight path is clear when the path, as a line, misses a figure that is grown by
//!    twice the rounding of the arithmetic (argument in `meeting`).
//! 2. Any other pair of convex pieces is clear for a stretch of the path only if a plane proves it. The separation by
//!    this plane is computed in f64 from the support functions of both pieces, less a forward error bound
//!    (`piece::NOISE` times the sum of all magnitudes that entered). The way in which the plane was found does not
//!    matter.
//! 3. Along a translation the separation by a fixed plane is linear; along a turn `turning` bounds it from below. A
//!    stretch ends where this separation reaches the margin, and stretches follow each other without a gap.
//! 4. When the broad phase drops a pair, the boxes of its pieces never overlap during the move. These boxes are rounded
//!    outward by the same error bound and then to single precision. Every place that the broad phase computes along the
//!    path carries `space::sweep::SLACK_MM`. Rounding places and heights to codes and to layers keeps their order, for
//!    pieces and mover alike.
//! 5. `solid` finds a body inside a closed mesh, and counts a doubtful body as inside; `closed` finds the closed
//!    surfaces of a mesh, however untidy its file is.
//! 6. A comparison with NaN is false, and every comparison is written so that false means blocked. Iteration limits,
//!    invalid moves and invalid bodies mean blocked ([`ElementKey::UNDECIDABLE`]).
//!
//! # Why f64 with bounds
//! With whole micrometres every comparison would be exact, but moves would be blocked up to 2 um too early, where at
//! most 1e-6 mm is allowed. Expansion arithmetic (exact sums of floating-point numbers) would decide cases within
//! rounding, where the answer is blocked anyway. So numbers stay f64 as given, and every proof subtracts its own
//! rounding.
//!
//! # Tolerances
//! | name | value | covers |
//! |---|---|---|
//! | `piece::NOISE` | 96 roundings, relative | everything between the numbers of a scene and a plane or a figure |
//! | `meeting::ROUNDING` | 32 roundings, relative | closed forms, between two places and a fraction of the path |
//! | `grazing::ROUNDING` | 2^-94, relative | grazing contacts in double-double precision |
//! | `meeting::GRAZED_MM` | 1e-7 mm | how early a grazing contact may come before `grazing` refines it |
//! | `meeting::ROUND_MM` | 1e-3 mm | least distance from the end of a round corner at which `grazing` may refine |
//! | `distance::RESOLUTION_MM` | 1e-9 mm | where a search for a plane stops |
//! | `space::sweep::SLACK_MM` | 1e-5 mm | places along the path in the broad phase; costs candidates, changes no answer |
//! | `space::cover::ULP` | 1.2e-7, relative | rounding outward to f32; changes no answer |
//! | `space::codes` | steps of 1/32 mm in squares up to 1.9 m, coarser on larger plates | silhouettes as whole numbers of 16 bits; costs candidates, changes no answer |
//! | `mover::SINGLE`, `space::boxes::EARLIER`, `space::codes::EARLIER` | 1e-6, relative | boxes of the mover and their times in f32; changes no answer |
//! | `pose::NEARLY_UNIT` | 1e-9 | deviation from 1 of the squared length of a quaternion whose yaw is taken without a division, for boxes only; within `mover::SINGLE` |
//! | `space::sweep::SLOWEST_MM` | 1e-9 mm | displacement along an axis that counts as rest; changes no answer |
//! | `closed::WELD_MM` | 1e-6 mm | corners that count as one when closed surfaces are sought |
//! | `turning::band_mm` | 1e-7 to 5e-4 mm | distance beyond the margin that counts as contact on a turning move |
//! | `turning::LEAST_RESOLUTION_MM` | 2e-4 mm | least distance of turning moves |
//! | `scene::face::FLAT` | 1e-4, relative to the face | flatness and convexity of faces with more than three corners in a file |
//!
//! # How early a move may be blocked
//! - Straight moves: the verdict is designed to stay within 1e-6 mm of the margin for coordinates up to 1e6 mm. This
//!   depends on the searches for planes, which are tested against constructed truth but not proven to converge: in the
//!   60,000 pairs that a test draws (needles, foils, tilts of 1e-12, places up to 1e6 mm) the proven distance is at
//!   most 5e-7 mm too small, and never too great.
//! - Turning moves: at most 5e-4 mm.
//! - The place of a contact that only grazes a round side may be reported too early, by the root of twice the radius
//!   times the rounding: up to 1e-4 mm within a metre. This happens where bodies reached their places by rounding
//!   (turned, kept with a margin, or at places whose sums are not exact in double precision). The verdict keeps its
//!   1e-6 mm. Where nothing was rounded, `grazing` keeps the place within 1e-6 mm as well.

#![allow(
    clippy::neg_cmp_op_on_partial_ord,
    reason = "a comparison with NaN must fall to the blocked side"
)]

mod answer;
mod candidates;
mod closed;
mod contact;
mod distance;
pub mod exact;
mod grazing;
mod interior;
mod meeting;
mod model;
mod mover;
mod name;
mod nearest;
mod outline;
mod passage;
mod path;
mod permission;
mod piece;
mod pose;
mod prism;
mod question;
mod rest;
pub mod scene;
mod search;
mod shape;
mod solid;
mod space;
mod stationary;
mod straight;
#[cfg(test)]
mod tests;
mod touch;
mod turning;
mod vector;

pub use answer::{Answer, Clearance, Contact, ElementKey, Move};
pub use model::Model;
pub use mover::{Mover, Moving};
pub use outline::{View, outlines};
pub use permission::{Forbidden, Passing, Permission};
pub use pose::Pose;
pub use shape::{Flaw, LARGEST_COORDINATE_MM, Mesh, Shape};

/// Makes `cargo test` compile the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
