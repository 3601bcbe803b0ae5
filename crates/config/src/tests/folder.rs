//! Tests of the configuration that is compiled in, and of the directories that it is written to.

use super::revision::files;
use crate::{Change, Folder, InitError, Plant, check_all, init, load_recipe, revise, revision};
use serde_json::json;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};

const NAME: &str = "jzc-22f-012";

fn config() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../config")
}

/// Returns every file below the folder by its path within it.
fn texts(folder: &Path) -> BTreeMap<String, String> {
    let within = |path: String| {
        let within = Path::new(&path).strip_prefix(folder).unwrap();
        within.display().to_string()
    };
    let all = files(folder).into_iter();
    all.map(|(path, text)| (within(path), text)).collect()
}

/// Returns the files of `config/` itself, without earlier revisions and without the rigs below it.
fn default_rig() -> BTreeMap<String, String> {
    let mut files = texts(&config());
    let other = ["recipes/revisions/", "rigs/"];
    files.retain(|name, _| !other.iter().any(|it| name.starts_with(it)));
    files
}

#[test]
fn every_file_of_the_configuration_is_compiled_in() {
    let Folder::Memory(memory) = Folder::built_in() else {
        unreachable!("files in memory")
    };
    let repository = default_rig();
    let names: Vec<&String> = repository.keys().collect();
    assert_eq!(
        memory.texts().keys().collect::<Vec<_>>(),
        names,
        "list the files in crates/config/src/built_in.rs"
    );
    assert_eq!(memory.texts(), repository);
}

#[test]
fn every_rig_of_the_repository_is_compiled_in() {
    let entries = fs::read_dir(config().join("rigs")).unwrap();
    let names = entries.map(|it| it.unwrap().file_name().into_string().unwrap());
    let names: BTreeSet<String> = names.collect();
    let known: Vec<&str> = Folder::built_in_rigs().collect();
    assert_eq!(known[0], "jzc-22f", "the rig of the folder itself");
    assert_eq!(
        names,
        known[1..].iter().map(|it| (*it).to_owned()).collect()
    );
    for name in names {
        let Some(Folder::Memory(memory)) = Folder::built_in_rig(&name) else {
            unreachable!("files in memory")
        };
        let mut repository = texts(&config().join("rigs").join(&name));
        repository.retain(|name, _| !name.starts_with("recipes/revisions/"));
        assert_eq!(memory.texts(), repository, "{name}");
    }
    assert!(Folder::built_in_rig("none").is_none());
}

#[test]
fn the_compiled_in_configuration_loads_as_its_directory() {
    let (built_in, directory) = (Folder::built_in(), Folder::Directory(config()));
    check_all(&built_in).unwrap();
    let recipe = |folder| load_recipe(folder, NAME).unwrap();
    assert_eq!(recipe(&built_in).hash, recipe(&directory).hash);
    assert_eq!(
        crate::recipe_names(&built_in),
        crate::recipe_names(&directory)
    );
}

#[test]
fn a_picture_lies_directly_in_its_folder() {
    let plant = tempfile::tempdir().unwrap();
    fs::create_dir_all(plant.path().join("pictures/old")).unwrap();
    for file in [
        "pictures/nest.svg",
        "pictures/old/nest.svg",
        "nest.svg",
        "pictures/nest.txt",
    ] {
        fs::write(plant.path().join(file), "x").unwrap();
    }
    let folder = Folder::from(plant.path());
    let found = folder.picture("nest.svg");
    assert_eq!(found, Some(("image/svg+xml", b"x".to_vec())));
    for other in [
        "old/nest.svg",
        "../nest.svg",
        "nest.svg/",
        "nest.txt",
        "none.svg",
        "svg",
        "",
    ] {
        assert_eq!(folder.picture(other), None, "{other}");
    }
    assert_eq!(Folder::built_in().picture("nest.svg"), None);
}

#[test]
fn revisions_in_memory_last_as_long_as_the_folder() {
    let plant = Plant::load(&Folder::built_in()).unwrap();
    let first = revision(&plant.folder, NAME, None).unwrap();
    assert_eq!(
        (first.number, first.kept, first.saved_at_us),
        (1, false, None)
    );
    for (number, volts) in [(2, 8.7), (3, 8.8)] {
        let change = Change {
            name: NAME.into(),
            from: revision(&plant.folder, NAME, None).unwrap().hash,
            reason: "tighter".into(),
            save_as: None,
            values: [("limits.operate_voltage_v.high".to_owned(), json!(volts))].into(),
        };
        let saved = revise(&plant, &change).unwrap();
        assert_eq!((saved.number, saved.newest), (number, number));
        assert!(saved.saved_at_us.is_some());
        let loaded = load_recipe(&plant.folder.clone(), NAME).unwrap();
        assert_eq!(loaded.hash, saved.hash);
    }
    let kept = revision(&plant.folder, NAME, Some(1)).unwrap();
    assert_eq!((kept.hash, kept.newest), (first.hash.clone(), 3));
    let again = revision(&Folder::built_in(), NAME, None).unwrap();
    assert_eq!((again.number, again.hash), (1, first.hash));
}

#[test]
fn init_writes_every_file_to_new_and_empty_directories() {
    let folder = tempfile::tempdir().unwrap();
    let (new, empty) = (folder.path().join("plant/rig1"), folder.path().join("rig2"));
    fs::create_dir(&empty).unwrap();
    for dir in [&new, &empty] {
        init(dir, "jzc-22f").unwrap();
        assert_eq!(texts(dir), default_rig());
        check_all(&Folder::Directory(dir.clone())).unwrap();
    }
    let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
    assert_eq!(mode(&new), mode(&folder.path().join("plant")));
    let entries = |dir: &Path| fs::read_dir(dir).unwrap().count();
    assert_eq!((entries(new.parent().unwrap()), entries(&empty)), (1, 11));
}

#[test]
fn init_adds_profiles_and_explanations_to_a_rig() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("rig");
    init(&dir, "ssr").unwrap();
    let (written, own) = (texts(&dir), texts(&config().join("rigs/ssr")));
    for (name, text) in &own {
        assert_eq!(written.get(name), Some(text), "{name}");
    }
    assert!(written.contains_key("instruments/smu-2450.toml") && written.contains_key("README.md"));
    check_all(&Folder::Directory(dir)).unwrap();
    let unknown = init(&folder.path().join("other"), "none").unwrap_err();
    let expected = "found rig \"none\", expected one of jzc-22f, ssr, thermostat";
    assert_eq!(unknown.to_string(), expected);
}

#[test]
fn init_leaves_a_directory_with_entries_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("rig.toml"), "mine").unwrap();
    let refused = init(folder.path(), "jzc-22f").unwrap_err();
    assert!(matches!(refused, InitError::NotEmpty { .. }), "{refused}");
    let file = folder.path().join("rig.toml");
    let refused = init(&file, "jzc-22f").unwrap_err();
    assert!(matches!(refused, InitError::Unwritten { .. }), "{refused}");
    let below = init(&file.join("rig1"), "jzc-22f").unwrap_err();
    assert!(matches!(below, InitError::Unwritten { .. }), "{below}");
    assert_eq!(
        texts(folder.path()),
        [("rig.toml".into(), "mine".into())].into()
    );
}

#[test]
fn a_missing_directory_names_the_command_that_writes_one() {
    let missing = Folder::Directory("nowhere".into());
    let expected = "nowhere: found no such folder, expected a configuration (`relayrig init nowhere` writes one, \
                    --config names another one)";
    assert_eq!(Plant::load(&missing).unwrap_err().to_string(), expected);
    assert_eq!(
        load_recipe(&missing, NAME).unwrap_err().to_string(),
        expected
    );
    assert_eq!(check_all(&missing).unwrap_err().to_string(), expected);
}
