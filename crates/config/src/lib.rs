//! The files of the plant: read, checked, and handed to each module in that module's own types.
//!
//! | file | holds | becomes |
//! |---|---|---|
//! | `rig.toml` | lines, modules, points, mechanism, references | [`Wiring`], the settings of `gauge` |
//! | `scene.toml` | the bodies around the nest | `GuardSettings` |
//! | `golden.toml` (named in `rig.toml`) | certified relays | `ReferenceSet` |
//! | `card.toml` | what the process card says of the plant | `CardSettings` |
//! | `lot.toml`, which may be missing | gates of a lot | `LotSettings` |
//! | `recipes/NAME.toml` | one kind of part | `Recipe` |
//! | `recipes/revisions/NAME/N.toml` | what it was before | [`Revision`] |
//!
//! Three steps, each with its own kind of message, all of one form
//! `file:line: key: found ..., expected ...`: the text must be TOML; every key must be known, present, of its
//! type and in its range ([`check`], from the tables in [`keys`]); and the whole must fit together (an address
//! used once, low not above high), which the module that owns the settings decides.
//! `sim.toml` describes the simulated world and is no business of the controller.

mod card;
pub mod check;
mod edit;
pub mod error;
pub mod keys;
mod lot;
pub mod nearest;
pub mod plant;
#[cfg(test)]
pub(crate) mod readme;
pub mod recipes;
mod revision;
pub mod schema;
mod sheet;
pub mod tree;

#[cfg(test)]
mod tests;

pub use card::load_card;
pub use error::ConfigError;
pub use plant::Plant;
pub use recipes::{load_recipe, recipe_names};
pub use revision::{Change, Revision, revise, revision};
