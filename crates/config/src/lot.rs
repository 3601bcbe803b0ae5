//! Loads `lot.toml`, the gates of a lot: reference checks, reject-rate limit, first articles, wear limits. Without the
//! file a lot has none of them.

use super::check::File;
use super::error::ConfigError;
use super::keys;
use machine::station::gates::LotSettings;
use std::path::Path;

/// Reads and checks the gates of a lot.
pub(super) fn load_lot(dir: &Path) -> Result<LotSettings, ConfigError> {
    let path = dir.join("lot.toml");
    if !path.exists() {
        return Ok(LotSettings::default());
    }
    File::read(path, "the gates of a lot")?.settings(keys::lot::FILE)
}
