//! Configuration: reads and checks the files of a plant and returns them as settings of the modules that own them.
//!
//! | file | holds | becomes |
//! |---|---|---|
//! | `rig.toml` | lines, modules, points, mechanism, references | [`Wiring`], the settings of `gauge` |
//! | `scene.toml` | the bodies around the nest | `GuardSettings` |
//! | `golden.toml` (named in `rig.toml`) | reference parts | `ReferenceSet` |
//! | `card.toml` | figures of the plant for the process card | `CardSettings` |
//! | `lot.toml`, which may be missing | gates of a lot | `LotSettings` |
//! | `recipes/NAME.toml` | one kind of part | `Recipe` |
//! | `recipes/revisions/NAME/N.toml` | earlier revisions of it | [`Revision`] |
//!
//! Loading has three steps, with messages of the form `file:line: key: found ..., expected ...`: the text must be TOML; every
//! key must be known, present, of its type and in its range ([`check`], by the tables in [`keys`]); the values must fit
//! together (an address used once, low not above high), which the module that owns the settings checks. The controller does
//! not read `sim.toml`, which describes the simulated world.

mod card;
pub mod check;
mod edit;
pub mod error;
mod faults;
pub mod keys;
mod lot;
pub mod nearest;
mod overview;
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
pub use faults::{ConfigFaults, check_all};
pub use overview::overview;
pub use plant::Plant;
pub use recipes::{load_recipe, recipe_names};
pub use revision::{Change, Revision, revise, revision};
