//! Paths, tests, links and commands in documents exist, and documents keep their length limits.

mod markdown;

use super::tree::{Source, assert_none, root, rust_files};
use markdown::quoted;
use std::fs;

/// Documents with their longest length: bytes, characters for the Chinese one.
const BOUNDED: &[(&str, usize)] = &[
    ("README.md", 6144),
    ("ARCHITECTURE.md", 10_240),
    ("docs/operating.md", 8192),
    ("docs/operating.zh.md", 8192),
    ("docs/commissioning.md", 8192),
    ("docs/bus.md", 8192),
    ("docs/installing.md", 8192),
    ("docs/bench.md", 6144),
    ("docs/instruments.md", 6144),
    ("docs/measuring.md", 12_288),
    ("docs/integrating.md", 8192),
    ("docs/extending.md", 6144),
    ("docs/fleet.md", 6144),
    ("docs/limits.md", 6144),
    ("docs/prompts.md", 4096),
    ("docs/external.md", 6144),
    ("docs/serials.md", 6144),
    ("docs/tooling.md", 4096),
];

/// Documents without a length limit.
const UNBOUNDED: &[&str] = &[
    "CHANGELOG.md",
    "config/README.md",
    "docs/SUMMARY.md",
    "docs/figures.md",
];

/// Longest table cell, words.
const CELL: usize = 25;

/// Folders by which a quoted text is recognised as a path.
const ROOTS: &[&str] = &[
    "src/",
    "crates/",
    "sim/",
    "config/",
    "tests/",
    ".ci/",
    "docs/",
    "packaging/",
];

/// Reads the existing documents.
pub fn documents() -> Vec<Source> {
    let names = BOUNDED.iter().map(|(name, _)| name);
    let written = names
        .chain(UNBOUNDED)
        .filter(|name| root().join(name).exists());
    let read = |name: &&str| Source {
        path: (*name).to_owned(),
        text: fs::read_to_string(root().join(name)).unwrap(),
    };
    written.map(read).collect()
}

/// Returns documents of sentences, without lists of keys or changes.
fn bounded() -> impl Iterator<Item = (Source, usize)> {
    documents().into_iter().filter_map(|document| {
        let (_, most) = BOUNDED.iter().find(|(name, _)| *name == document.path)?;
        Some((document, *most))
    })
}

#[test]
fn every_document_of_the_folder_has_a_bound() {
    let entries = fs::read_dir(root().join("docs")).unwrap();
    let names = entries.map(|entry| format!("docs/{}", entry.unwrap().file_name().display()));
    let known: Vec<String> = documents().into_iter().map(|it| it.path).collect();
    let unknown = names.filter(|name| name.ends_with(".md") && !known.contains(name));
    let broken: Vec<String> = unknown.map(|name| format!("{name}: no bound")).collect();
    assert_none(&broken);
}

#[test]
fn no_document_is_longer_than_its_bound() {
    let mut broken = Vec::new();
    for (Source { path, text }, most) in bounded() {
        let length = match path.ends_with(".zh.md") {
            true => text.chars().count(),
            false => text.len(),
        };
        if length > most {
            broken.push(format!("{path}: {length}, expected at most {most}"));
        }
    }
    assert_none(&broken);
}

#[test]
fn no_table_cell_is_longer_than_a_sentence() {
    let mut broken = Vec::new();
    for (Source { path, text }, _) in bounded() {
        let long = markdown::cells(&text)
            .into_iter()
            .filter(|(_, cell)| markdown::words(cell) > CELL);
        broken.extend(long.map(|(line, cell)| format!("{path}:{line}: {cell}")));
    }
    assert_none(&broken);
}

#[test]
fn every_link_in_the_documents_resolves() {
    let mut broken = Vec::new();
    for document in documents() {
        for (line, target) in markdown::links(&document.text) {
            if !target.contains("://") && !resolves(&document, &target) {
                broken.push(format!("{}:{line}: {target} leads nowhere", document.path));
            }
        }
    }
    assert_none(&broken);
}

fn resolves(document: &Source, target: &str) -> bool {
    let (file, anchor) = target.split_once('#').unwrap_or((target, ""));
    let path = match (file, root().join(&document.path)) {
        ("", own) => own,
        (_, own) => own.with_file_name(file),
    };
    let has_anchor = || {
        let text = fs::read_to_string(&path).unwrap_or_default();
        markdown::anchors(&text).iter().any(|it| it == anchor)
    };
    path.exists() && (anchor.is_empty() || has_anchor())
}

/// Checks that the program accepts the words, with `--help` so that nothing runs.
#[cfg(feature = "sim")]
#[test]
fn every_command_line_in_the_documents_parses() {
    let mut broken = Vec::new();
    for document in documents() {
        for (number, line) in markdown::command_lines(&document.text) {
            let mut program = std::process::Command::new(env!("CARGO_BIN_EXE_relayrig"));
            let words = markdown::arguments(&line);
            let said = program.args(words).arg("--help").output().unwrap();
            if !said.status.success() {
                let why = String::from_utf8_lossy(&said.stderr);
                let why = why.lines().next().unwrap_or_default();
                broken.push(format!("{}:{number}: {line}: {why}", document.path));
            }
        }
    }
    assert_none(&broken);
}

#[test]
fn every_path_named_in_the_documents_exists() {
    let mut broken = Vec::new();
    for document in documents() {
        for (line, quoted) in quoted(&document.text) {
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
        for (line, name) in quoted(&document.text) {
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

/// Expands `handling/{feed,nest}.rs` to two paths. For NAME and * only the folder must exist.
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
        paths("crates/cycle/src/lib.rs:12"),
        ["crates/cycle/src/lib.rs"]
    );
    assert!(paths("cargo run").is_empty());
}
