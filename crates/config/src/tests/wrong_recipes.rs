//! Tests of recipes that no rig, or not this rig, can carry out: each is refused with key, found and expected.
//!
//! `wrong_recipes.txt` has one block per recipe: first the changes to a recipe of `config/`, with `-` for a key that is
//! left out; then all faults, indented, in the order of the message.

use super::super::{Plant, check::File, recipes::parse_recipe};
use std::fmt::Write;
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

/// Returns every fault of the changed recipe, one per line.
fn faults(plant: &Plant, changed: &str) -> String {
    let (name, changes) = changed.split_once(": ").unwrap();
    let path = plant.dir.join(format!("recipes/{name}.toml"));
    let text = std::fs::read_to_string(&path).unwrap();
    let mut recipe: DocumentMut = text.parse().unwrap();
    for one in changes.split("; ") {
        let (path, value) = one.split_once(" = ").unwrap();
        change(&mut recipe, path, value);
    }
    let file = File::parse(path, recipe.to_string()).unwrap();
    let faults = match parse_recipe(file, name) {
        Ok(recipe) => plant.infeasible(&recipe),
        Err(error) => vec![error],
    };
    faults.iter().fold(String::new(), |mut lines, fault| {
        let fault = fault.to_string();
        let (_, fault) = fault.split_once(".toml:").unwrap();
        writeln!(
            lines,
            "    {}",
            fault.trim_start_matches(|c: char| c.is_ascii_digit() || c == ':' || c == ' ')
        )
        .unwrap();
        lines
    })
}

#[test]
fn every_wrong_recipe_is_refused_with_key_and_reason() {
    let dir = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../config");
    let plant = Plant::load(&dir).unwrap();
    let wrong = TABLE
        .lines()
        .filter(|line| !line.starts_with([' ', '#']) && !line.is_empty());
    let found: String = wrong.clone().fold(String::new(), |mut table, changed| {
        write!(table, "{changed}\n{}", faults(&plant, changed)).unwrap();
        table
    });
    let expected: String = TABLE
        .lines()
        .filter(|line| !line.starts_with('#') && !line.is_empty())
        .fold(String::new(), |mut table, line| {
            writeln!(table, "{line}").unwrap();
            table
        });
    for changed in wrong.clone() {
        assert!(!faults(&plant, changed).is_empty(), "accepted: {changed}");
    }
    assert!(wrong.count() >= 60);
    assert_eq!(found, expected, "found:\n{found}");
}
