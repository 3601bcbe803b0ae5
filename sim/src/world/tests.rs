//! Facts about the world: the relay by itself, and the line by hand.
#![allow(clippy::unwrap_used)]

mod crashes;
mod hand;
mod line;
mod magazine;
mod specimen;

use std::path::PathBuf;

use super::*;

fn config_dir() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../config"))
}
