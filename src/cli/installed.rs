//! Default paths: those of the working folder, or, when it has none, those of the installed rig.

use app::order::Files;
use config::Folder;
use std::path::{Path, PathBuf};

/// Folder of the configuration that the Debian package installs.
pub const CONFIG: &str = "/etc/relayrig";
/// History of the installed service.
pub const HISTORY: &str = "/var/lib/relayrig/relayrig.db";
/// Folder into which the installed timer makes its backups.
pub const BACKUPS: &str = "/var/backups/relayrig";

/// Name of the configuration in the working folder.
const LOCAL_CONFIG: &str = "config";
/// Name of the history in the working folder.
const LOCAL_HISTORY: &str = "relayrig.db";

/// Returns true when the working folder has neither a configuration nor a history, and a rig is installed.
pub fn is_default() -> bool {
    let local = [LOCAL_CONFIG, LOCAL_HISTORY];
    !local.iter().any(|it| Path::new(it).exists()) && Path::new(CONFIG).join("rig.toml").exists()
}

/// Returns true when the configuration that a command uses by default has this file or folder.
pub fn has(name: &str) -> bool {
    let config = if is_default() { CONFIG } else { LOCAL_CONFIG };
    Path::new(config).join(name).exists()
}

/// Returns the files of a command: those given, else the defaults.
pub fn files(config: Option<Folder>, db: Option<PathBuf>) -> Files {
    let (default_config, default_db) = match is_default() {
        true => (CONFIG, HISTORY),
        false => (LOCAL_CONFIG, LOCAL_HISTORY),
    };
    Files {
        config: config.unwrap_or_else(|| Folder::Directory(default_config.into())),
        db: db.unwrap_or_else(|| default_db.into()),
    }
}
