//! Loads `lot.toml`, the gates of a lot: reference checks, reject-rate limit, first articles, wear limits. Without the
//! file a lot has none of them.

use super::error::ConfigError;
use super::folder::Folder;
use super::keys;
use machine::station::gates::LotSettings;

/// Reads and checks the gates of a lot.
pub(super) fn load_lot(folder: &Folder) -> Result<LotSettings, ConfigError> {
    match folder.has("lot.toml") {
        true => folder
            .file("lot.toml", "the gates of a lot")?
            .settings(keys::lot::FILE),
        false => Ok(LotSettings::default()),
    }
}
