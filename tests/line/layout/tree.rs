//! The source tree: files, lines, lines without comments.

use std::fs;
use std::path::{Path, PathBuf};

/// One source file.
pub struct Source {
    /// Path from the root of the repository, with `/`.
    pub path: String,
    /// Whole text.
    pub text: String,
}

impl Source {
    /// Returns non-blank lines without comments, with numbers from 1.
    pub fn code(&self) -> impl Iterator<Item = (usize, &str)> {
        let numbered = self.text.lines().enumerate();
        let code = numbered.map(|(index, line)| (index + 1, without_comment(line)));
        code.filter(|(_, line)| !line.trim().is_empty())
    }

    /// Returns crate or module of a file: `gauge` for `crates/machine/src/gauge/budget.rs`, `bus` for
    /// `crates/bus/src/line.rs`, `cli` for `src/cli/run.rs`.
    pub fn room(&self) -> Option<&str> {
        let Some(inside) = self.path.strip_prefix("crates/") else {
            return first_module(self.path.strip_prefix("src/")?);
        };
        let (name, rest) = inside.split_once('/')?;
        match (name, first_module(rest.strip_prefix("src/")?)?) {
            ("machine" | "app", module) => Some(module),
            ("history", module @ ("report" | "inquiry")) => Some(module),
            (single, _) => Some(single),
        }
    }

    /// Returns true for a file of tests only.
    pub fn is_test(&self) -> bool {
        let path = self.path.as_str();
        let name = path.rsplit('/').next().unwrap_or(path);
        path.starts_with("tests/")
            || path.contains("/tests/")
            || name == "tests.rs"
            || name.ends_with("_tests.rs")
    }
}

fn first_module(path: &str) -> Option<&str> {
    let first = path.split('/').next()?;
    Some(first.strip_suffix(".rs").unwrap_or(first))
}

/// Removes a comment; `//` inside a string such as "http://" begins none.
fn without_comment(line: &str) -> &str {
    if line.trim_start().starts_with("//") {
        return "";
    }
    line.split_once(" //").map_or(line, |(code, _)| code)
}

/// Returns the root of the repository.
pub fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Returns every Rust file under the folders, in order of path.
pub fn rust_files(folders: &[&str]) -> Vec<Source> {
    let mut found = files(folders);
    found.retain(|source| source.path.ends_with(".rs"));
    assert!(!found.is_empty(), "no Rust file under {folders:?}");
    found
}

/// Returns every text file under the folders, in order of path.
pub fn files(folders: &[&str]) -> Vec<Source> {
    let mut found = Vec::new();
    for folder in folders {
        collect(&root().join(folder), &mut found);
    }
    found.sort_by(|one, other| one.path.cmp(&other.path));
    found
}

fn collect(folder: &Path, found: &mut Vec<Source>) {
    let Ok(entries) = fs::read_dir(folder) else {
        return;
    };
    for entry in entries {
        let path = entry.unwrap().path();
        if path.is_dir() {
            collect(&path, found);
        } else if let Ok(text) = fs::read_to_string(&path) {
            let path = path
                .strip_prefix(root())
                .unwrap()
                .to_string_lossy()
                .replace('\\', "/");
            found.push(Source { path, text });
        }
    }
}

/// Returns true when `line` has `word` as a whole word.
pub fn has_word(line: &str, word: &str) -> bool {
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    line.match_indices(word).any(|(at, _)| {
        let before = line[..at].chars().next_back();
        let after = line[at + word.len()..].chars().next();
        !before.is_some_and(is_part) && !after.is_some_and(is_part)
    })
}

/// Fails with every line of `broken`, so that one run of the test shows all of them.
pub fn assert_none(broken: &[String]) {
    assert!(broken.is_empty(), "\n{}\n", broken.join("\n"));
}

#[test]
fn comments_and_addresses_are_distinguished() {
    assert_eq!(without_comment("    /// uses std::fs"), "");
    assert_eq!(without_comment("let a = 1; // std::fs"), "let a = 1;");
    assert_eq!(
        without_comment("let a = \"http://x\";"),
        "let a = \"http://x\";"
    );
}

#[test]
fn a_word_is_not_found_inside_a_longer_one() {
    assert!(has_word("use std::fs;", "std::fs"));
    assert!(!has_word("my_async_task", "async"));
}
