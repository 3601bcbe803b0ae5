//! Tests of the world: the magazine, and the line under manual control.
#![allow(clippy::unwrap_used)]

mod crashes;
mod hand;
mod line;
mod magazine;
mod resistor;
mod supply;

use std::path::PathBuf;

use super::*;
use crate::truth::WorldRecord;

pub(super) fn config_dir() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../config"))
}

pub(super) fn files() -> Files {
    Files::Directory(config_dir())
}
