//! Loads `card.toml`.

use super::error::ConfigError;
use super::folder::Folder;
use super::keys;
use machine::dut::card::CardSettings;

/// Reads and checks what the plant states for the process card.
///
/// # Errors
/// Fails as [`super::Plant::load`] does.
pub fn load_card(folder: &Folder) -> Result<CardSettings, ConfigError> {
    folder
        .file("card.toml", "the figures of the plant for the process card")?
        .settings(keys::card::FILE)
}
