//! Loading of `card.toml`.

use super::check::File;
use super::error::ConfigError;
use super::keys;
use machine::dut::card::CardSettings;
use std::path::Path;

/// Reads and checks the figures of the plant for the process card.
///
/// # Errors
/// As [`super::Plant::load`].
pub fn load_card(dir: &Path) -> Result<CardSettings, ConfigError> {
    let file = File::read(
        dir.join("card.toml"),
        "the figures of the plant for the process card",
    )?;
    file.settings(keys::card::FILE)
}
