//! Errors of a configuration: they name the file and, where known, line, key, what was found and what was expected.

use machine::rig::fault::Requirement;
use std::path::PathBuf;
use texts::{Lang, Message};
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
        /// The requirement of `expected` as a code, for texts in other languages.
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
    /// No instrument profile has this name.
    #[error("{}: found no instrument profile \"{name}\", expected one of {}", dir.display(), list(known))]
    UnknownInstrument {
        /// Folder of the profiles.
        dir: PathBuf,
        /// Name in the request.
        name: String,
        /// Names of the existing profiles.
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
    /// A new recipe has a name that cannot name its file.
    #[error("{}", new_name("recipe_name", .found).say(Lang::En))]
    RecipeName {
        /// Name in the request.
        found: String,
    },
    /// A new recipe has the name of another one; upper and lower case count as equal.
    #[error("{}", new_name("recipe_taken", .name).say(Lang::En))]
    RecipeTaken {
        /// Name of the existing recipe.
        name: String,
    },
    /// A change has no reason.
    #[error("reason: found nothing, expected why the values change")]
    NoReason,
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
    /// Returns the refusal in both languages; the Chinese text names no file, line or key.
    pub fn message(&self) -> Message {
        let refusal = |code: &'static str| Message::new("refusal", code);
        let said = |code| refusal(code).with("said", self);
        match self {
            Self::UnknownRecipe { name, .. } => said("no_such_recipe").with("recipe", name),
            Self::UnknownInstrument { name, .. } => {
                said("no_such_instrument").with("instrument", name)
            }
            Self::UnknownRevision {
                name,
                number,
                newest,
            } => said("no_such_revision")
                .with("recipe", name)
                .with("number", number)
                .with("newest", newest),
            Self::NotNewest { newest, .. } => refusal("not_newest").with("newest", newest),
            Self::RecipeName { found } => new_name("recipe_name", found),
            Self::RecipeTaken { name } => new_name("recipe_taken", name),
            Self::NoReason => refusal("revision_without_reason"),
            Self::Value { .. } => said("value_refused"),
            Self::NothingChanged { .. } => said("nothing_changed"),
            Self::Unwritten { .. } => said("not_written"),
            Self::NoFolder { .. }
            | Self::Unreadable { .. }
            | Self::Syntax { .. }
            | Self::Rule { .. } => said("recipe_faulty"),
        }
    }

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
            | Self::UnknownInstrument { .. }
            | Self::UnknownRevision { .. }
            | Self::NotNewest { .. }
            | Self::NothingChanged { .. }
            | Self::RecipeName { .. }
            | Self::RecipeTaken { .. }
            | Self::NoReason
            | Self::Unwritten { .. } => None,
        }
    }
}

fn new_name(code: &'static str, name: &str) -> Message {
    Message::new("refusal", code).with("recipe", name)
}

fn list(names: &[String]) -> String {
    if names.is_empty() {
        return "(there is none)".to_owned();
    }
    names.join(", ")
}
