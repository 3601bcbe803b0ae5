//! Loads `card.toml`.

use super::check::File;
use super::error::ConfigError;
use super::keys;
use machine::dut::card::CardSettings;
use std::path::Path;

/// Reads and checks what the plant states for the process card.
///
/// # Errors
/// Fails as [`super::Plant::load`] does.
pub fn load_card(dir: &Path) -> Result<CardSettings, ConfigError> {
    let file = File::read(
        dir.join("card.toml"),
        "the figures of the plant for the process card",
    )?;
    file.settings(keys::card::FILE)
}
