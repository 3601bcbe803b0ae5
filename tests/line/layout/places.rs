//! Entries of the top level, length of files, names of files.

use super::tree::{assert_none, files, has_word, root, rust_files};
use std::process::Command;

/// Allowed entries at the top of the repository.
const TOP: &[&str] = &[
    ".ci",
    ".gitignore",
    "ARCHITECTURE.md",
    "CHANGELOG.md",
    "Cargo.lock",
    "Cargo.toml",
    "LICENSE-APACHE",
    "LICENSE-MIT",
    "README.md",
    "config",
    "crates",
    "docs",
    "locale",
    "packaging",
    "sim",
    "src",
    "tests",
];

/// Longest file, lines.
const LONGEST: usize = 500;

/// File names that say nothing about the content.
const EMPTY_NAMES: &[&str] = &[
    "utils", "util", "common", "helpers", "helper", "manager", "misc", "types",
];

#[test]
fn the_top_level_holds_the_listed_entries_only() {
    let stray: Vec<String> = top_level()
        .into_iter()
        .filter(|name| !TOP.contains(&name.as_str()))
        .collect();
    assert!(
        stray.is_empty(),
        "at the top of the repository: {stray:?}, expected only {TOP:?}"
    );
}

/// Lists the files under version control; without git, all files but products of builds and runs.
fn top_level() -> Vec<String> {
    let git = Command::new("git")
        .args(["ls-files", "-z"])
        .current_dir(root())
        .output();
    let mut names: Vec<String> = match git {
        Ok(listed) if listed.status.success() && !listed.stdout.is_empty() => {
            let text = String::from_utf8_lossy(&listed.stdout).into_owned();
            text.split('\0')
                .filter_map(|path| path.split('/').next())
                .map(str::to_owned)
                .collect()
        }
        Ok(_) | Err(_) => root()
            .read_dir()
            .unwrap()
            .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
            .filter(|name| ![".git", "target"].contains(&name.as_str()) && !name.contains(".db"))
            .collect(),
    };
    names.retain(|name| !name.is_empty());
    names.sort();
    names.dedup();
    names
}

#[test]
fn a_file_is_about_one_idea() {
    let mut broken = Vec::new();
    for source in rust_files(&["src", "crates", "sim", "tests"]) {
        let lines = source.text.lines().count();
        if lines > LONGEST {
            broken.push(format!(
                "{}: {lines} lines, at most {LONGEST}: there is a second idea in it",
                source.path
            ));
        }
    }
    assert_none(&broken);
}

#[test]
fn a_file_is_named_after_what_is_in_it() {
    let mut broken = Vec::new();
    for source in rust_files(&["src", "crates", "sim", "tests"]) {
        let empty = source
            .path
            .split(['/', '.'])
            .find(|part| EMPTY_NAMES.contains(part));
        if let Some(name) = empty {
            broken.push(format!(
                "{}: `{name}` says nothing about what is inside",
                source.path
            ));
        }
    }
    assert_none(&broken);
}

#[test]
fn every_module_says_what_it_is() {
    let undocumented = rust_files(&["src", "crates", "sim/src"])
        .into_iter()
        .filter(|source| !source.is_test());
    let broken: Vec<String> = undocumented
        .filter(|source| !source.text.trim_start().starts_with("//!"))
        .map(|source| {
            format!(
                "{}:1: the first line says what the file is for",
                source.path
            )
        })
        .collect();
    assert_none(&broken);
}

/// Texts that belong to a private workplace: home paths, notes.
#[test]
fn documents_name_no_private_path_or_person() {
    let homes = ["root", "home", "Users", "work"].map(|home| format!("/{home}/"));
    let notes = [
        concat!("TO", "DO"),
        concat!("FIX", "ME"),
        concat!("XX", "X"),
        concat!("HA", "CK"),
        concat!("WI", "P"),
    ];
    let mut broken = Vec::new();
    for source in files(&[
        "src",
        "crates",
        "sim",
        "tests",
        "config",
        ".ci",
        "packaging",
    ])
    .iter()
    .chain(&super::documents::documents())
    {
        for (line, text) in source.text.lines().enumerate() {
            let word = homes
                .iter()
                .map(String::as_str)
                .find(|home| text.contains(home));
            let word = word.or_else(|| notes.into_iter().find(|note| has_word(text, note)));
            if let Some(word) = word {
                broken.push(format!(
                    "{}:{}: {word:?} belongs to a private workplace",
                    source.path,
                    line + 1
                ));
            }
        }
    }
    assert_none(&broken);
}
