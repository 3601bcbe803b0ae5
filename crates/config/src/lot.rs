//! Loading of `lot.toml`, which may be missing: then a lot has no gates.

use super::check::File;
use super::error::ConfigError;
use super::keys;
use machine::station::gates::LotSettings;
use std::path::Path;

/// Reads and checks by what a lot is run.
pub(super) fn load_lot(dir: &Path) -> Result<LotSettings, ConfigError> {
    let path = dir.join("lot.toml");
    if !path.exists() {
        return Ok(LotSettings::default());
    }
    File::read(path, "the gates of a lot")?.settings(keys::lot::FILE)
}
