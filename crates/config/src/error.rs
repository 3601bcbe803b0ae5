//! Errors of a configuration: the file, and where known line, key, found, expected.

use std::path::PathBuf;
use thiserror::Error;

/// The first fault that loading finds. Its text is one line for the operator.
#[derive(Debug, Error)]
pub enum ConfigError {
    /// The file is missing or cannot be read.
    #[error("{}: found no readable file, expected {expected}", file.display())]
    Unreadable {
        /// Path of the file.
        file: PathBuf,
        /// Expected content of the file.
        expected: &'static str,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// Not TOML: a stray character, a key given twice, an unclosed text.
    #[error("{}:{line}: {problem}, expected valid TOML", file.display())]
    Syntax {
        /// Path of the file.
        file: PathBuf,
        /// Line of the first fault, from 1.
        line: usize,
        /// Message of the parser, in one line.
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
        /// The value in words.
        found: String,
        /// Accepted values.
        expected: String,
    },
    /// A file breaks a rule of the module that owns it, for example `scene.toml` one of the guard.
    #[error("{}:{line}: {problem}", file.display())]
    Rule {
        /// Path of the file.
        file: PathBuf,
        /// Line of the key; from 1.
        line: usize,
        /// Message of that module: key, found, expected.
        problem: String,
    },
    /// No recipe of that name.
    #[error("{}: found no recipe \"{name}\", expected one of {}", dir.display(), list(known))]
    UnknownRecipe {
        /// Folder of the recipes.
        dir: PathBuf,
        /// The name asked for.
        name: String,
        /// Existing recipes.
        known: Vec<String>,
    },
    /// No revision of that number.
    #[error("recipe \"{name}\": found revision {number}, expected 1 to {newest}")]
    UnknownRevision {
        /// Name of the recipe.
        name: String,
        /// The number asked for.
        number: u32,
        /// Number of the newest revision.
        newest: u32,
    },
    /// A change begins from a revision that is no longer the newest.
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
    /// A change leaves every value as it is.
    #[error("{}: found no value that differs, expected a change", file.display())]
    NothingChanged {
        /// Path of the file.
        file: PathBuf,
    },
    /// A revision could not be written.
    #[error("{}: the new revision could not be written; the old one stays", file.display())]
    Unwritten {
        /// Path of the file.
        file: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
}

impl ConfigError {
    /// Returns the path of the faulty key, `limits.operate_voltage_v.high`; `None` for faults of a whole file.
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
        return "(there are no recipes)".to_owned();
    }
    names.join(", ")
}
