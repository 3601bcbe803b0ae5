//! Errors of a configuration: they name the file and, where known, line, key, what was found and what was expected.

use machine::rig::fault::Requirement;
use std::path::PathBuf;
use thiserror::Error;

/// First fault that loading finds. Its text is one line, written for the operator.
#[derive(Debug, Error)]
pub enum ConfigError {
    /// The file is missing or cannot be read.
    #[error("{}: found no readable file, expected {expected}", file.display())]
    Unreadable {
        /// Path of the file.
        file: PathBuf,
        /// What the file should contain.
        expected: &'static str,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The directory does not exist.
    #[error(
        "{0}: found no such folder, expected a configuration (`relayrig init {0}` writes one, --config names another one)",
        dir.display()
    )]
    NoFolder {
        /// Path of the directory.
        dir: PathBuf,
    },
    /// The text is not TOML: a stray character, a key given twice, a string without end.
    #[error("{}:{line}: {problem}, expected valid TOML", file.display())]
    Syntax {
        /// Path of the file.
        file: PathBuf,
        /// Line of the first fault, from 1.
        line: usize,
        /// Message of the parser, in one line.
        problem: String,
    },
    /// A key is missing, unknown, of the wrong type, out of range, or contradicts another key.
    #[error("{}:{line}: {key}: found {found}, expected {expected}", file.display())]
    Value {
        /// Path of the file.
        file: PathBuf,
        /// Line of the key, or of the table in which it is missing; from 1.
        line: usize,
        /// Key with its table, for example `[analog_in].coil_voltage.channel`.
        key: String,
        /// Value found, in words.
        found: String,
        /// Accepted values.
        expected: String,
        /// The requirement behind `expected`.
        requirement: Box<Requirement>,
    },
    /// A file breaks a rule of the module that owns its settings, for example `scene.toml` a rule of the guard.
    #[error("{}:{line}: {problem}", file.display())]
    Rule {
        /// Path of the file.
        file: PathBuf,
        /// Line of the key, from 1.
        line: usize,
        /// Message of the module that owns the settings: key, found, expected.
        problem: String,
    },
    /// No recipe has this name.
    #[error("{}: found no recipe \"{name}\", expected one of {}", dir.display(), list(known))]
    UnknownRecipe {
        /// Folder of the recipes.
        dir: PathBuf,
        /// Name in the request.
        name: String,
        /// Names of the existing recipes.
        known: Vec<String>,
    },
    /// The recipe has no revision with this number.
    #[error("recipe \"{name}\": found revision {number}, expected 1 to {newest}")]
    UnknownRevision {
        /// Name of the recipe.
        name: String,
        /// Number in the request.
        number: u32,
        /// Number of the newest revision.
        newest: u32,
    },
    /// A change is based on a revision that is no longer the newest.
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
    /// A new revision could not be written.
    #[error("{}: the new revision could not be written; the old one stays", file.display())]
    Unwritten {
        /// Path of the file.
        file: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
}

impl ConfigError {
    /// Returns the path of the faulty key, for example `limits.operate_voltage_v.high`; `None` for errors that
    /// name no key.
    pub fn key(&self) -> Option<String> {
        match self {
            Self::Value { key, .. } => {
                let path = key.strip_prefix('[').unwrap_or(key);
                Some(path.replace('[', ".").replace(']', ""))
            }
            Self::Unreadable { .. }
            | Self::NoFolder { .. }
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
