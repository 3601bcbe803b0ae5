//! The documents speak of things that exist: paths, tests, commands.

use super::tree::{Source, assert_none, root, rust_files};
use std::fs;

const DOCUMENTS: &[&str] = &[
    "README.md",
    "ARCHITECTURE.md",
    "CHANGELOG.md",
    "config/README.md",
    "docs/extending.md",
];

/// Folders in which a quoted path must lie to be taken for one.
const ROOTS: &[&str] = &[
    "src/", "crates/", "sim/", "config/", "tests/", ".ci/", "docs/",
];

/// The documents as they are.
pub fn documents() -> Vec<Source> {
    let read = |name: &&str| Source {
        path: (*name).to_owned(),
        text: fs::read_to_string(root().join(name)).unwrap(),
    };
    DOCUMENTS.iter().map(read).collect()
}

#[test]
fn every_path_named_in_the_documents_exists() {
    let mut broken = Vec::new();
    for document in documents() {
        for (line, quoted) in quoted(&document) {
            for path in paths(&quoted) {
                if !root().join(&path).exists() {
                    broken.push(format!("{}:{line}: `{path}` does not exist", document.path));
                }
            }
        }
    }
    assert_none(&broken);
}

/// In ARCHITECTURE.md every quoted name of four words or more is the name of a test.
#[test]
fn every_test_named_in_the_architecture_exists() {
    let sources = rust_files(&["src", "crates", "sim", "tests"]);
    let mut broken = Vec::new();
    for document in documents()
        .into_iter()
        .filter(|document| document.path == "ARCHITECTURE.md")
    {
        for (line, name) in quoted(&document) {
            let is_name = name
                .bytes()
                .all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == b'_');
            let declared = format!("fn {name}(");
            if is_name
                && name.matches('_').count() >= 3
                && !sources.iter().any(|source| source.text.contains(&declared))
            {
                broken.push(format!(
                    "{}:{line}: there is no test `{name}`",
                    document.path
                ));
            }
        }
    }
    assert_none(&broken);
}

#[test]
fn the_readme_names_the_command_that_the_checks_run() {
    let readme = fs::read_to_string(root().join("README.md")).unwrap();
    let checks = fs::read_to_string(root().join(".ci/run")).unwrap();
    let command = "cargo test --workspace";
    assert!(
        readme.contains(command),
        "README.md does not name `{command}`"
    );
    let last = checks
        .lines()
        .rev()
        .find(|line| !line.trim().is_empty())
        .unwrap();
    assert!(
        last.starts_with(command),
        ".ci/run ends in {last:?}, expected `{command}`"
    );
}

/// What stands between single back-ticks, with its line.
fn quoted(document: &Source) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    for (index, line) in document.text.lines().enumerate() {
        let inside = line.split('`').skip(1).step_by(2);
        found.extend(inside.map(|text| (index + 1, text.to_owned())));
    }
    found
}

/// `crates/machine/src/handling/{feed,nest}.rs` is two paths; NAME and * stand for any name: then the folder must exist.
fn paths(quoted: &str) -> Vec<String> {
    if !ROOTS.iter().any(|start| quoted.starts_with(start)) || quoted.contains(char::is_whitespace)
    {
        return Vec::new();
    }
    let path = quoted.split(':').next().unwrap_or(quoted);
    let path = match path.find(['*', '<']).or_else(|| path.find("NAME")) {
        Some(at) => &path[..path[..at].rfind('/').unwrap_or(0)],
        None => path,
    };
    match (path.find('{'), path.find('}')) {
        (Some(open), Some(close)) if open < close => path[open + 1..close]
            .split(',')
            .map(|middle| format!("{}{}{}", &path[..open], middle.trim(), &path[close + 1..]))
            .collect(),
        (_, _) => vec![path.to_owned()],
    }
}

#[test]
fn a_path_in_a_document_is_taken_apart() {
    assert_eq!(
        paths("crates/machine/src/handling/{feed,nest}.rs"),
        [
            "crates/machine/src/handling/feed.rs",
            "crates/machine/src/handling/nest.rs"
        ]
    );
    assert_eq!(paths("config/recipes/NAME.toml"), ["config/recipes"]);
    assert_eq!(
        paths("crates/app/src/cycle.rs:12"),
        ["crates/app/src/cycle.rs"]
    );
    assert!(paths("cargo run").is_empty());
}
