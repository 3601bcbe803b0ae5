//! Configuration files of a rig: where they are, and how to read one.

use std::collections::BTreeMap;
use std::io::{Error, ErrorKind};
use std::path::{Path, PathBuf};

use crate::config::ConfigError;
use crate::table::Table;

/// Configuration files of a rig.
#[derive(Debug, Clone)]
pub enum Files {
    /// The files below this directory.
    Directory(PathBuf),
    /// Texts by name, for example `recipes/jzc-22f-012.toml`.
    Texts(BTreeMap<String, String>),
}

impl Default for Files {
    fn default() -> Self {
        Self::Texts(BTreeMap::new())
    }
}

impl From<&Path> for Files {
    fn from(dir: &Path) -> Self {
        Self::Directory(dir.to_owned())
    }
}

impl Files {
    /// Returns the path of a file as messages show it.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        match self {
            Self::Directory(dir) => dir.join(name),
            Self::Texts(_) => name.into(),
        }
    }

    pub(crate) fn read(&self, name: &str) -> Result<Table, ConfigError> {
        let path = self.path(name);
        match self {
            Self::Directory(_) => Table::of_file(&path),
            Self::Texts(texts) => match texts.get(name) {
                Some(text) => Table::parse(&path, text),
                None => Err(ConfigError::Read {
                    path,
                    source: Error::from(ErrorKind::NotFound),
                }),
            },
        }
    }

    pub(crate) fn recipe(&self, name: &str) -> Result<Table, ConfigError> {
        self.read(&format!("recipes/{name}.toml"))
    }
}
