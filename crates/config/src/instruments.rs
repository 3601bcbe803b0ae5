//! Loads instrument profiles: `instruments/NAME.toml`.

use super::check::File;
use super::error::ConfigError;
use super::folder::Folder;
use super::keys;
use machine::rig::fault::Fault;
use machine::rig::instruments::{Profiles, unknown_profile};
use machine::rig::settings::{InstrumentSettings, RigSettings};
use scpi::Profile;
use std::sync::Arc;

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

/// Returns the names of all profiles of a folder, sorted; none when the folder cannot be read.
pub fn instrument_names(folder: &Folder) -> Vec<String> {
    folder.stems("instruments")
}

/// Returns the folder whose profiles a configuration uses: `folder`, or the built-in one when `folder` has no profiles.
pub fn folder_of_profiles(folder: &Folder) -> Folder {
    match instrument_names(folder).is_empty() {
        true => Folder::built_in(),
        false => folder.clone(),
    }
}

/// Loads the profiles that `rig` names.
pub(super) fn load_profiles(
    folder: &Folder,
    rig: &File,
    settings: &RigSettings,
) -> Result<Profiles, ConfigError> {
    let folder = folder_of_profiles(folder);
    let known = instrument_names(&folder);
    let mut profiles = Profiles::new();
    for (name, InstrumentSettings { profile, .. }) in &settings.instrument {
        if !known.contains(profile) {
            let fault = unknown_profile(name, profile, known.iter().map(String::as_str));
            return Err(rig.locate(&fault));
        }
        if !profiles.contains_key(profile) {
            let loaded = load_instrument(&folder, profile)?;
            profiles.insert(profile.clone(), Arc::new(loaded));
        }
    }
    Ok(profiles)
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
