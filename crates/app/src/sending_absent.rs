//! Replaces `sending.rs` in a program without feature `fleet`.

use super::controls::Controls;
use super::order::Files;

/// Returns `None`: the program sends to no database.
///
/// # Errors
/// Fails for a faulty `fleet.toml`, and for one that names a database.
pub(super) fn start(files: &Files, _: &Controls) -> anyhow::Result<Option<()>> {
    let fleet = config::load_fleet(&files.config)?;
    let path = files.config.path("fleet.toml");
    anyhow::ensure!(
        fleet.targets.is_empty(),
        "{}: found a target, expected none: this program was built without the feature `fleet`",
        path.display()
    );
    Ok(None)
}
