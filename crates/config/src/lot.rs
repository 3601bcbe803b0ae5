//! Loads `lot.toml`, the gates of a lot: reference checks, reject-rate limit, first articles, wear limits, and the
//! source of serial numbers. Without the file a lot has none of these.

use super::error::ConfigError;
use super::folder::Folder;
use super::keys;
use machine::dut::prompt::{self, Prompt};
use machine::handling::serial::{SourceName, counted};
use machine::rig::fault::Fault;
use machine::station::gates::LotSettings;

const LOT: &str = "the gates of a lot";

/// Reads and checks the gates of a lot.
pub(super) fn load_lot(folder: &Folder) -> Result<LotSettings, ConfigError> {
    if !folder.has("lot.toml") {
        return Ok(LotSettings::default());
    }
    let file = folder.file("lot.toml", LOT)?;
    let lot: LotSettings = file.settings(keys::lot::FILE)?;
    prompt::check(&lot.prompts)
        .and_then(|()| check_pictures(folder, &lot.prompts))
        .map_err(|fault| file.locate(&fault))?;
    let template = lot.serial.as_ref().map(|it| &it.template);
    match template.filter(|it| counted(it, "A", 1).is_none()) {
        None => Ok(lot),
        Some(template) => {
            let expected = "a text with {lot} and {number} or {number:06}, and no other braces";
            let fault = Fault::new("serial.template", format!("\"{template}\""), expected);
            Err(file.locate(&fault))
        }
    }
}

/// Reads the prompts of every lot from `lot.toml`.
///
/// # Errors
/// Fails when the file cannot be read or has a faulty key.
pub fn prompts_of_lots(folder: &Folder) -> Result<Vec<Prompt>, ConfigError> {
    load_lot(folder).map(|lot| lot.prompts)
}

/// Checks that the rig has a code reader if its lots take their serial numbers from one.
pub(super) fn check_reader(
    folder: &Folder,
    lot: &LotSettings,
    has_reader: bool,
) -> Result<(), ConfigError> {
    let source = lot.serial.as_ref().map(|it| it.source);
    if has_reader || source != Some(SourceName::Reader) {
        return Ok(());
    }
    let expected = "counted or wedge, because rig.toml has no [serial_reader]";
    let fault = Fault::new("serial.source", "\"reader\"", expected);
    Err(folder.file("lot.toml", LOT)?.locate(&fault))
}

/// Checks that the folder has the pictures of these prompts.
pub(super) fn check_pictures(folder: &Folder, prompts: &[Prompt]) -> Result<(), Fault> {
    for (place, prompt) in prompts.iter().enumerate() {
        let Some(name) = &prompt.picture else {
            continue;
        };
        if folder.picture(name).is_none() {
            let expected = "a PNG, JPEG or SVG file in pictures/";
            let key = format!("prompt.{place}.picture");
            return Err(Fault::new(key, format!("\"{name}\""), expected));
        }
    }
    Ok(())
}
