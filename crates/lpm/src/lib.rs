//! The collision core: may this body go this way between those that stand there?
//!
//! A library of its own: no clock, no file, no settings. [`Model`] holds the standing elements; a
//! [`Shape`] asks with a [`Move`] for [`Model::any_hit`] (the gate), [`Model::first_contact`] or
//! [`Model::clearance`]. Lengths are millimetres, frames right-handed, z is up.
//!
//! # The layer-based projection model
//! After Peng and others (2010), section 3 and 4: a checking space Omega over the baseplate whose
//! top follows its elements, cut into layers `{h1, h2, V, B}`; elements are put in and taken out one
//! by one; the broad phase asks for layer, silhouette and oriented box in this order and stops at the
//! first no. Layout of `V`, choice of layers and everything behind the broad phase are ours; the oriented box is
//! no step of its own here: what would be asked of it is asked of the piece itself, in closed form (`meeting`, `touch`)
//! or by a plane that is found for it (`distance`).
//! `space` is the broad phase: `layers` holds Omega and `{h1, h2}`, `grid` `V`, `silhouettes` `B`.
//!
//! # Beyond it: continuous and exact
//! The paper checks poses (`rest`), this module checks ways. Upright blocks and cylinders on a straight way
//! meet in closed form: `meeting`. Along a straight move the distance of any two convex pieces is
//! convex, so first contact and least distance follow from a few separating planes, for the true
//! shapes (cylinders stay round, in any orientation): `straight`. Turning moves advance
//! conservatively with a second-order bound: `turning`.
//! The gate asks for no distance (`contact`, `search`), a clearance for no more than the nearest (`nearest`).
//! What a pair may do (forbidden within a margin, may touch, ignored) is applied by `permission`.
//!
//! # Never a false clear
//! Bodies are closed sets: touching is contact. *Blocked* means that the distance comes within the
//! margin, or that this could not be excluded. The proof of *clear*:
//! 1. A pair of upright pieces on a straight way is cleared when a line misses a figure that was
//!    grown by twice the rounding of the arithmetic (`meeting`, where the argument stands).
//! 2. Any other pair of convex pieces is cleared for a stretch of the way only by an evaluated plane.
//!    Its separation is computed in f64 from the support functions of both pieces, and a forward error
//!    bound is subtracted (`piece::NOISE` times the sum of all magnitudes that entered). How the
//!    plane was found does not matter.
//! 3. Along a translation the separation by a fixed plane is linear, along a turn it is bounded
//!    from below by `turning`; a stretch ends where the bound reaches the margin, and stretches
//!    follow each other without a hole.
//! 4. A pair that the broad phase drops has boxes, rounded outward by the same bound and then to
//!    single precision, that never overlap during the way. All that the broad phase computes along
//!    the way carries `space::sweep::SLACK_MM`, and steps of height are monotone.
//! 5. A body inside a closed mesh is found by `solid`, where doubt means inside; what is closed, however untidy the
//!    file, by `closed`.
//! 6. NaN compares false: every comparison is written so that false means blocked. Iteration limits,
//!    invalid moves and bodies are blocked ([`ElementKey::UNDECIDABLE`]).
//!
//! # Why f64 with bounds
//! Whole micrometres would make every comparison exact and block up to 2 um too much; 1e-6 mm is what
//! may be blocked. Expansion arithmetic would decide within rounding, where the answer is blocked
//! anyway. So numbers stay f64 as they came and every proof pays for its own rounding.
//!
//! # Tolerances
//! | name | value | for |
//! |---|---|---|
//! | `piece::NOISE` | 96 roundings, relative | everything between the numbers of a scene and a plane or a figure |
//! | `meeting::ROUNDING` | 32 roundings, relative | closed forms, between two places and a fraction of the way |
//! | `grazing::ROUNDING` | 2^-94, relative | contacts that graze, in twice the digits |
//! | `meeting::GRAZED_MM` | 1e-7 mm | by how much a graze may come early before that is asked |
//! | `meeting::ROUND_MM` | 1e-3 mm | how far from the end of a round corner that is sound |
//! | `distance::RESOLUTION_MM` | 1e-9 mm | where a search for a plane stops |
//! | `space::sweep::SLACK_MM` | 1e-5 mm | places along the way in the broad phase; costs candidates, no answers |
//! | `space::cover::ULP` | 1.2e-7, relative | rounding outward to f32, likewise |
//! | `mover::SINGLE`, `space::boxes::EARLIER` | 1e-6, relative | boxes of the mover and their times in f32, likewise |
//! | `pose::NEARLY_UNIT` | 1e-9 | squared length of a quaternion whose yaw is taken without a quotient for boxes; within `mover::SINGLE` |
//! | `space::sweep::SLOWEST_MM` | 1e-9 mm | what counts as rest on an axis, likewise |
//! | `closed::WELD_MM` | 1e-6 mm | corners that are one when it is asked what a mesh closes |
//! | `turning::band_mm` | 1e-7 to 5e-4 mm | how near to the margin a turning move counts as contact |
//! | `turning::LEAST_RESOLUTION_MM` | 2e-4 mm | least distance of turning moves |
//! | `scene::face::FLAT` | 1e-4, relative to the face | how flat and convex a face of more than three corners in a file must be |
//!
//! # What a false blocked costs
//! A contact that only grazes a round side is reported early by the root of twice the radius times the
//! rounding where bodies came to their places by rounding (turned, kept with a margin, or at places whose
//! sums are no numbers of double precision): up to 1e-4 mm within a metre. The verdict keeps its 1e-6 mm.
//! Where nothing was rounded the stop does, too: `grazing`.
//! Straight: meant to stay within 1e-6 mm of the margin for coordinates up to 1e6 mm. This rests on
//! the searches for planes, which are tested against built truth, not proven to converge: of the 60,000
//! pairs that a test draws (needles, foils, tilts of 1e-12, places up to 1e6 mm) none loses more than 5e-7 mm, always to
//! the safe side.
//! Turning: at most 5e-4 mm.

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
mod standing;
mod straight;
#[cfg(test)]
mod tests;
mod touch;
mod turning;
mod vector;

pub use answer::{Answer, Clearance, Contact, ElementKey, Move};
pub use model::Model;
pub use mover::{Mover, Moving};
pub use outline::{Seen, outlines};
pub use permission::{Forbidden, Passing, Permission};
pub use pose::Pose;
pub use shape::{Flaw, LARGEST_COORDINATE_MM, Mesh, Shape};

/// Keeps the example of the README compiling.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
