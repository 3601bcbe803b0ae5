//! Configuration: reads and checks the files of a plant, and makes the settings of each crate from these files.
//!
//! | file | holds | becomes |
//! |---|---|---|
//! | `rig.toml` | lines, modules, points, mechanism, references | [`Wiring`](machine::rig::wiring::Wiring), the settings of `gauge` |
//! | `scene.toml` | the bodies around the nest | `GuardSettings` |
//! | `golden.toml` (named in `rig.toml`) | reference parts | `ReferenceSet` |
//! | `card.toml` | what the plant states for the process card | `CardSettings` |
//! | `fleet.toml`, which may be missing | databases that collect the histories of many rigs | [`FleetSettings`] |
//! | `lot.toml`, which may be missing | gates of a lot: reference checks, reject-rate limit, first articles, wear limits | `LotSettings` |
//! | `instruments/NAME.toml`, which may be missing | one model of SCPI instrument | `Profile` |
//! | `recipes/NAME.toml` | one type of part with its limits | `Recipe` |
//! | `recipes/revisions/NAME/N.toml` | earlier revisions of that recipe | [`Revision`] |
//!
//! Loading has three steps, and a fault in any of them gives a message `file:line: key: found ..., expected ...`:
//!
//! 1. The text must be TOML.
//! 2. Every key must be known, present, of its type and in its range ([`check`], by the tables in [`keys`]).
//! 3. The values must fit together (no address used twice, low not above high); the module that owns the settings
//!    checks that.
//!
//! The files are those of a [`Folder`]: a directory, or files in memory that begin as the copy of `config/` in the
//! program. [`init()`] writes that copy to a directory. The controller does not read `sim.toml`, which describes the
//! simulated world.
//!
//! ```
//! use config::{Folder, Plant, load_recipe};
//! let folder = Folder::built_in();
//! let plant = Plant::load(&folder)?;
//! assert_eq!(plant.wiring.lines.len(), 2);
//! let recipe = load_recipe(&folder, "jzc-22f-012")?;
//! assert_eq!(recipe.name, "jzc-22f-012");
//! # Ok::<(), config::ConfigError>(())
//! ```

mod built_in;
mod card;
pub mod check;
mod edit;
pub mod error;
mod faults;
mod fleet;
mod folder;
mod init;
mod instruments;
pub mod keys;
mod lot;
pub mod nearest;
mod overview;
pub mod plant;
#[cfg(test)]
pub(crate) mod readme;
pub mod recipes;
mod revision;
mod scenes;
pub mod schema;
mod sheet;
pub mod strict;
pub mod tree;

#[cfg(test)]
mod tests;

pub use card::load_card;
pub use error::ConfigError;
pub use faults::{ConfigFaults, check_all};
pub use fleet::{FleetSettings, FleetTarget, SampleChoice, Shift, TlsChoice, load_fleet};
pub use folder::{Folder, Memory};
pub use init::{InitError, init};
pub use instruments::{folder_of_profiles, instrument_names, load_instrument};
pub use lot::prompts_of_lots;
pub use overview::overview;
pub use plant::{HistorySettings, Plant, SerialReaderSettings};
pub use recipes::{Approval, approval, load_recipe, recipe_names};
pub use revision::{Change, Revision, revise, revision};
pub use scenes::{SCENE, scene_names, scene_text};
