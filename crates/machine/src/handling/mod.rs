//! How parts get to the instruments and into bins.
//!
//! Signals: end sensors of every actuator, part sensors of pocket, nest and gripper, a beam in the chute of each bin. A
//! sensor is believed for [`mechanism::SENSOR_AGE`]; what was not read is unknown, never a guess.
//!
//! Normal sequence: [`feed`] lets one part into the pocket and pushes it into the nest, [`nest`] clamps it, has it
//! tested and hands it to the fingers, [`sort`] carries it to its bin, lets it go and waits for the beam. The three
//! overlap; [`feeder`] steps them once per turn, and the [`ledger`] holds which part is in which [`place`].
//!
//! Troubles ([`trouble`]): a stroke that does not arrive ([`mechanism`]) or an actuator that leaves its end (`watch`),
//! a part that does not come, sticks or falls; each with its place, none with a text.
//!
//! After a restart: [`recovery`] brings every actuator to rest and compares the ledger with the sensors; [`inside`] is
//! what a run before left.
//!
//! Not handled here: what stops at which trouble, orders, gates of the lot. The station does that, with alarms.

pub mod feed;
pub mod feeder;
pub mod inside;
pub mod ledger;
pub mod mechanism;
pub mod moves;
pub mod nest;
pub mod place;
pub mod recovery;
pub mod sort;
pub mod trouble;
pub mod turn;
pub mod wants;
mod watch;
pub mod wear;

pub use feeder::Feeder;
pub use ledger::Ledger;
pub use mechanism::Mechanism;
pub use moves::Move;
pub use place::{NestId, Place};

#[cfg(test)]
pub(crate) mod tests;
