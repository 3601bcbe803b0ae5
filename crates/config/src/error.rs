//! Why a configuration was refused: always the file, and as far as known line, key, found, expected.

use std::path::PathBuf;
use thiserror::Error;

/// The first thing that loading refuses. Its text is one line, ready for the operator.
#[derive(Debug, Error)]
pub enum ConfigError {
    /// The file is missing or cannot be read.
    #[error("{}: found no readable file, expected {expected}", file.display())]
    Unreadable {
        /// Path as it was asked for.
        file: PathBuf,
        /// What the file should have held.
        expected: &'static str,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// Not TOML: a stray character, a key given twice, an unclosed text.
    #[error("{}:{line}: {problem}, expected valid TOML", file.display())]
    Syntax {
        /// Path of the file.
        file: PathBuf,
        /// Line of the first fault, from 1.
        line: usize,
        /// The parser's words, in one line.
        problem: String,
    },
    /// A key that is missing, unknown, of the wrong type, out of range or at odds with another.
    #[error("{}:{line}: {key}: found {found}, expected {expected}", file.display())]
    Value {
        /// Path of the file.
        file: PathBuf,
        /// Line of the key, or of the table in which it is missing; from 1.
        line: usize,
        /// The key with its table, as `[analog_in].coil_voltage.channel`.
        key: String,
        /// The value, in words.
        found: String,
        /// What would have been accepted.
        expected: String,
    },
    /// A file that brings its own rules (`scene.toml`) breaks one of them.
    #[error("{}:{line}: {problem}", file.display())]
    Rule {
        /// Path of the file.
        file: PathBuf,
        /// Line of the key; from 1.
        line: usize,
        /// The key, what was found and what was expected, in the words of the file's owner.
        problem: String,
    },
    /// No recipe of that name.
    #[error("{}: found no recipe \"{name}\", expected one of {}", dir.display(), list(known))]
    UnknownRecipe {
        /// The folder that was searched.
        dir: PathBuf,
        /// The name asked for.
        name: String,
        /// The recipes that exist.
        known: Vec<String>,
    },
    /// A revision that never was.
    #[error("recipe \"{name}\": found revision {number}, expected 1 to {newest}")]
    UnknownRevision {
        /// Name of the recipe.
        name: String,
        /// The number asked for.
        number: u32,
        /// The greatest there is.
        newest: u32,
    },
    /// A change of a text that another revision has replaced.
    #[error(
        "recipe \"{name}\": the revision that this change begins from is no longer the newest, which is {newest}; nothing was \
         saved"
    )]
    NotNewest {
        /// Name of the recipe.
        name: String,
        /// Number of the newest revision.
        newest: u32,
    },
    /// A change after which every value is what it was.
    #[error("{}: found no value that differs, expected a change", file.display())]
    NothingChanged {
        /// Path of the file.
        file: PathBuf,
    },
    /// A revision that could not be put in place.
    #[error("{}: the new revision could not be written; the old one stays", file.display())]
    Unwritten {
        /// Path of the file.
        file: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
}

impl ConfigError {
    /// Path of the key that is wrong, `limits.operate_voltage_v.high`, where a single one is.
    pub fn key(&self) -> Option<String> {
        match self {
            Self::Value { key, .. } => {
                let path = key.strip_prefix('[').unwrap_or(key);
                Some(path.replace('[', ".").replace(']', ""))
            }
            Self::Unreadable { .. }
            | Self::Syntax { .. }
            | Self::Rule { .. }
            | Self::UnknownRecipe { .. }
            | Self::UnknownRevision { .. }
            | Self::NotNewest { .. }
            | Self::NothingChanged { .. }
            | Self::Unwritten { .. } => None,
        }
    }
}

fn list(names: &[String]) -> String {
    if names.is_empty() {
        return "(there is no recipe at all)".to_owned();
    }
    names.join(", ")
}
