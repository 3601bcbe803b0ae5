//! Scenes of a configuration: the fixture of the rig, and the tooling for other body sizes in `nests`.

use super::folder::Folder;

/// Name of the scene of the rig.
pub const SCENE: &str = "scene.toml";

/// Returns the names of the scenes: that of the rig first, then those of `nests`, sorted.
pub fn scene_names(folder: &Folder) -> Vec<String> {
    let own = folder.has(SCENE).then(|| SCENE.to_owned());
    let nests = folder.stems("nests").into_iter();
    own.into_iter()
        .chain(nests.map(|stem| format!("nests/{stem}.toml")))
        .collect()
}

/// Returns the text of a scene.
///
/// # Errors
/// Fails when the file cannot be read.
pub fn scene_text(folder: &Folder, name: &str) -> std::io::Result<String> {
    folder.read(name)
}
