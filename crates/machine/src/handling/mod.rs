//! Handling: brings parts to the instruments and into bins, with a feeder or by the hand of a person.
//!
//! Signals: end sensors of every actuator, part sensors of pocket, nest and gripper, and in the chute of each bin a
//! light barrier, the *beam*. A sensor value is valid for [`mechanism::SENSOR_AGE`]; a sensor without a valid value
//! counts as unknown, and no state is guessed for it.
//!
//! A rig has a [`feeder`] or a [`batch`] of sockets; [`ledger`], [`serial`] numbers, [`trouble`] and events of parts
//! are the same for both. The rest of this page describes the feeder; [`batch`] has its own page.
//!
//! Normal sequence: [`feed`] lets one part into the pocket and pushes it into the nest; [`nest`] holds and tests it
//! and hands it to the fingers; [`sort`] carries it to its bin, releases it and waits for the beam. The three overlap;
//! [`feeder`] steps them once per turn, and the [`ledger`] knows the part in each [`place`].
//!
//! Troubles ([`trouble`]): a late stroke ([`mechanism`]), an actuator that leaves its end (`watch`), a part that does
//! not come, sticks or falls. A trouble names its place and has no text.
//!
//! After a restart: [`recovery`] brings every actuator to rest and compares the ledger with the sensors; [`inside`]
//! holds the parts left by an earlier run.
//!
//! Not handled here: reactions to troubles, orders, and the conditions (gates) of a lot. The station handles these,
//! with alarms.

pub mod batch;
pub mod feed;
pub mod feeder;
pub mod inside;
pub mod ledger;
pub mod mechanism;
pub mod moves;
pub mod nest;
pub mod output;
pub mod place;
pub mod recovery;
pub mod serial;
pub mod sort;
mod stroke_times;
pub mod trouble;
pub mod turn;
mod watch;
pub mod wear;

pub use batch::Batch;
pub use feeder::Feeder;
pub use ledger::Ledger;
pub use mechanism::Mechanism;
pub use moves::Move;
pub use place::{NestId, Place};

#[cfg(test)]
pub(crate) mod tests;
