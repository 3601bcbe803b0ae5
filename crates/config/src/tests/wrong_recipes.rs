//! Tests of recipes that no rig, or not this rig, can carry out: each refusal names key, found and expected value.
//!
//! `wrong_recipes.txt` has one block per recipe: first the changes to a recipe of `config/`, with `-` for a key that is
//! left out; then all faults, indented, in the order of the message.

use crate::{check_all, init};
use std::path::Path;
use toml_edit::DocumentMut;

const TABLE: &str = include_str!("wrong_recipes.txt");

/// Sets `path` to a value in TOML notation; `-` removes the key.
fn change(recipe: &mut DocumentMut, path: &str, value: &str) {
    let (tables, key) = path.rsplit_once('.').unwrap_or(("", path));
    let names = tables.split('.').filter(|name| !name.is_empty());
    let table = names.fold(recipe.as_item_mut(), |item, name| &mut item[name]);
    let table = table.as_table_like_mut().unwrap();
    if value == "-" {
        assert!(table.remove(key).is_some(), "{path} is not in the recipe");
        return;
    }
    let entry: DocumentMut = format!("value = {value}").parse().unwrap();
    table.insert(key, entry["value"].clone());
}

/// Returns every fault that the check of the configuration finds after the changes of one recipe, one per line.
fn faults(dir: &Path, changed: &str) -> String {
    let (name, changes) = changed.split_once(": ").unwrap();
    let path = dir.join(format!("recipes/{name}.toml"));
    let text = std::fs::read_to_string(&path).unwrap();
    let mut recipe: DocumentMut = text.parse().unwrap();
    for one in changes.split("; ") {
        let (path, value) = one.split_once(" = ").unwrap();
        change(&mut recipe, path, value);
    }
    std::fs::write(&path, recipe.to_string()).unwrap();
    let checked = check_all(&dir.into());
    std::fs::write(&path, text).unwrap();
    let faults = checked.map_or_else(|faults| faults.to_string(), |_| "accepted".to_owned());
    let folder = format!("{}/recipes/", dir.display());
    let faults = faults.lines().filter(|line| !line.ends_with(" faults"));
    faults.fold(String::new(), |lines, fault| {
        format!("{lines}    {}\n", fault.replace(&folder, ""))
    })
}

#[test]
fn every_wrong_recipe_is_refused_with_key_and_reason() {
    let copy = tempfile::tempdir().unwrap();
    init(copy.path(), "jzc-22f").unwrap();
    let table: String = TABLE
        .lines()
        .filter(|line| !line.starts_with('#') && !line.is_empty())
        .fold(String::new(), |table, line| format!("{table}{line}\n"));
    let wrong = table.lines().filter(|line| !line.starts_with(' '));
    let found = wrong.clone().fold(String::new(), |found, changed| {
        format!("{found}{changed}\n{}", faults(copy.path(), changed))
    });
    assert!(wrong.count() >= 60);
    assert!(!found.contains("    accepted\n"), "{found}");
    assert_eq!(found, table, "{found}");
}
