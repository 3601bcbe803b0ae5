//! Loads instrument profiles: `instruments/NAME.toml`.

use super::check::File;
use super::error::ConfigError;
use super::folder::Folder;
use super::keys;
use machine::rig::fault::Fault;
use scpi::Profile;

/// Reads and checks the profile `name` of a configuration.
///
/// # Errors
/// Fails when no profile has this name, or as [`super::Plant::load`] does.
pub fn load_instrument(folder: &Folder, name: &str) -> Result<Profile, ConfigError> {
    parse_instrument(read_instrument(folder, name)?, name)
}

/// Reads the file of a profile. Only the name of an existing profile becomes a path, so `../rig` is refused.
pub(super) fn read_instrument(folder: &Folder, name: &str) -> Result<File, ConfigError> {
    folder.check_exists()?;
    let known = instrument_names(folder);
    if !known.iter().any(|known| known == name) {
        return Err(ConfigError::UnknownInstrument {
            dir: folder.path("instruments"),
            name: name.to_owned(),
            known,
        });
    }
    folder.file(&format!("instruments/{name}.toml"), "an instrument profile")
}

/// Returns the names of all profiles, sorted; none when the folder cannot be read.
pub fn instrument_names(folder: &Folder) -> Vec<String> {
    folder.stems("instruments")
}

pub(super) fn parse_instrument(file: File, name: &str) -> Result<Profile, ConfigError> {
    let profile: Profile = file.settings(keys::instrument::FILE)?;
    if profile.name != name {
        let expected = format!("\"{name}\", as the file is called");
        let fault = Fault::new("name", format!("\"{}\"", profile.name), expected);
        return Err(file.locate(&fault));
    }
    let located = |fault: scpi::ProfileFault| {
        file.locate(&Fault::new(fault.key, fault.found, fault.expected))
    };
    profile.check().map_err(located)?;
    Ok(profile)
}
